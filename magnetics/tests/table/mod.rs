//! Reads the reference tables: lines of comment, a header, rows.

#![allow(dead_code)] // every test binary compiles this module and uses a part of it

use lbm_ibm_coupling::Vec3;

pub struct Table {
    header: Vec<String>,
    rows: Vec<Vec<String>>,
}

pub struct Row<'a> {
    header: &'a [String],
    cells: &'a [String],
}

impl Table {
    pub fn read(text: &str) -> Self {
        let split = |line: &str| line.split(',').map(|c| c.trim().to_owned()).collect::<Vec<_>>();
        let mut lines = text.lines().filter(|l| !l.starts_with('#') && !l.is_empty());
        let header = split(lines.next().expect("a header"));
        Self {
            header,
            rows: lines.map(split).collect(),
        }
    }

    pub fn rows(&self) -> impl Iterator<Item = Row<'_>> {
        self.rows.iter().map(|cells| Row {
            header: &self.header,
            cells,
        })
    }
}

impl Row<'_> {
    pub fn text(&self, column: &str) -> &str {
        let at = self.header.iter().position(|h| h == column).expect(column);
        &self.cells[at]
    }

    pub fn number(&self, column: &str) -> f64 {
        self.text(column).parse().expect(column)
    }

    pub fn vector(&self, x: &str, y: &str, z: &str) -> Vec3 {
        Vec3::new(self.number(x), self.number(y), self.number(z))
    }
}
