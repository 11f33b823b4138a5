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
