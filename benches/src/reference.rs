//! Reference data: CSV files with `#` comment lines that give source, units and formula.

use std::collections::BTreeMap;
use std::path::{Path, PathBuf};

/// Why reference data cannot be used.
#[derive(Debug, thiserror::Error)]
#[non_exhaustive]
pub enum ReferenceError {
    /// The file cannot be read.
    #[error("cannot read {}: {source}", path.display())]
    Read {
        /// The file.
        path: PathBuf,
        /// What went wrong.
        source: csv::Error,
    },
    /// A column names something that this package does not know.
    #[error("column `{column}` of {table} names `{text}`, which is not known")]
    Unknown {
        /// Name of the table.
        table: String,
        /// Column.
        column: String,
        /// What stands there.
        text: String,
    },
    /// No row has what was asked for.
    #[error("no row of {table} has {column} = {text}; there are {known}")]
    NoRow {
        /// Name of the table.
        table: String,
        /// Column.
        column: String,
        /// What was asked for.
        text: String,
        /// What the rows have there.
        known: String,
    },
    /// A row lacks a column, or holds something that is not a number.
    #[error("column `{column}` of {table} is missing or not a number: `{text}`")]
    Column {
        /// Name of the table.
        table: String,
        /// Column.
        column: String,
        /// What stands there.
        text: String,
    },
}

/// The rows of a reference file.
#[derive(Clone, Debug)]
pub struct Table {
    name: String,
    rows: Vec<Row>,
}

/// A row: text by column name.
#[derive(Clone, Debug)]
pub struct Row {
    table: String,
    fields: BTreeMap<String, String>,
}

impl Table {
    /// The folder that comes with this package.
    pub fn own_folder() -> PathBuf {
        Path::new(env!("CARGO_MANIFEST_DIR")).join("reference")
    }

    /// Reads `name`.csv from a folder.
    ///
    /// # Errors
    /// [`ReferenceError::Read`].
    pub fn read(folder: &Path, name: &str) -> Result<Self, ReferenceError> {
        let path = folder.join(format!("{name}.csv"));
        let fail = |source| ReferenceError::Read {
            path: path.clone(),
            source,
        };
        let mut reader = csv::ReaderBuilder::new()
            .comment(Some(b'#'))
            .flexible(true)
            .from_path(&path)
            .map_err(fail)?;
        let headers = reader.headers().map_err(fail)?.clone();
        let mut rows = Vec::new();
        for record in reader.records() {
            let record = record.map_err(fail)?;
            let fields = headers.iter().map(|h| h.trim().to_owned()).zip(join_brackets(&record));
            rows.push(Row {
                table: name.to_owned(),
                fields: fields.collect(),
            });
        }
        Ok(Self {
            name: name.to_owned(),
            rows,
        })
    }

    /// Only the rows with this in a column; numbers are compared as such.
    ///
    /// # Errors
    /// [`ReferenceError::NoRow`], [`ReferenceError::Column`] where there is no such column.
    pub fn only(mut self, column: &str, text: &str) -> Result<Self, ReferenceError> {
        let same = |field: &str| match (field.parse::<f64>(), text.parse::<f64>()) {
            (Ok(a), Ok(b)) => a == b,
            _ => field == text,
        };
        let mut known: Vec<&str> = Vec::new();
        for row in &self.rows {
            let field = row.text(column)?;
            if !known.contains(&field) {
                known.push(field);
            }
        }
        if !known.iter().any(|k| same(k)) {
            return Err(ReferenceError::NoRow {
                table: self.name.clone(),
                column: column.to_owned(),
                text: text.to_owned(),
                known: known.join(", "),
            });
        }
        self.rows.retain(|row| row.fields.get(column).is_some_and(|f| same(f)));
        Ok(self)
    }

    /// The name, that of the case.
    pub fn name(&self) -> &str {
        &self.name
    }

    /// All rows.
    pub fn rows(&self) -> &[Row] {
        &self.rows
    }
}

/// The fields of a record; a comma in brackets belongs to its field.
fn join_brackets(record: &csv::StringRecord) -> Vec<String> {
    let mut fields: Vec<String> = Vec::new();
    for text in record {
        match fields.last_mut() {
            Some(open) if open.matches('(').count() > open.matches(')').count() => {
                open.push(',');
                open.push_str(text);
            }
            _ => fields.push(text.to_owned()),
        }
    }
    fields.iter().map(|f| f.trim().to_owned()).collect()
}

impl Row {
    /// Text of a column.
    ///
    /// # Errors
    /// [`ReferenceError::Column`].
    pub fn text(&self, column: &str) -> Result<&str, ReferenceError> {
        self.fields
            .get(column)
            .map(String::as_str)
            .ok_or_else(|| self.missing(column, ""))
    }

    /// Number in a column; `nan` is a number.
    ///
    /// # Errors
    /// [`ReferenceError::Column`].
    pub fn number(&self, column: &str) -> Result<f64, ReferenceError> {
        let text = self.text(column)?;
        text.parse().map_err(|_| self.missing(column, text))
    }

    /// The named columns as `name=text`, to tell rows apart in a report.
    pub fn key(&self, columns: &[&str]) -> BTreeMap<String, String> {
        let pick = |c: &&str| Some(((*c).to_owned(), self.fields.get(*c)?.clone()));
        columns.iter().filter_map(pick).collect()
    }

    /// The error of a text that names nothing known.
    pub fn unknown(&self, column: &str) -> ReferenceError {
        ReferenceError::Unknown {
            table: self.table.clone(),
            column: column.to_owned(),
            text: self.fields.get(column).cloned().unwrap_or_default(),
        }
    }

    fn missing(&self, column: &str, text: &str) -> ReferenceError {
        ReferenceError::Column {
            table: self.table.clone(),
            column: column.to_owned(),
            text: text.to_owned(),
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn rows_are_chosen_by_what_they_have() {
        let table = || Table::read(&Table::own_folder(), "capsule_tube").expect("the package has it");
        let all = table().rows().len();
        let some = table().only("law", "SK").and_then(|t| t.only("Ca", "0.10"));
        let some = some.expect("there are such rows");
        assert!(!some.rows().is_empty() && some.rows().len() < all);
        for row in some.rows() {
            assert_eq!(row.text("law").ok(), Some("SK"));
            assert_eq!(row.number("Ca").ok(), Some(0.1));
        }
        assert!(matches!(table().only("Ca", "7"), Err(ReferenceError::NoRow { .. })));
        assert!(matches!(
            table().only("no such", "7"),
            Err(ReferenceError::Column { .. })
        ));
    }
}
