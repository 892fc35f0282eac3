//! The data of a figure → CSV.

/// A table under way.
pub struct Table {
    head: String,
    writer: csv::Writer<Vec<u8>>,
}

impl Table {
    /// Begins a table: the figure and its caption as `# ` lines, further ones, and the names of the columns.
    pub fn new(number: u8, caption: &str, lines: &[String], columns: &[&str]) -> csv::Result<Table> {
        let mut head = format!(concat!("# rocking-block ", env!("CARGO_PKG_VERSION"), " figure {}\n"), number);
        for line in std::iter::once(caption).chain(lines.iter().map(String::as_str)) {
            head.push_str(&format!("# {}\n", line.replace(['\n', '\r', '\u{A0}'], " ")));
        }
        let mut writer = csv::Writer::from_writer(Vec::new());
        writer.write_record(columns)?;
        Ok(Table { head, writer })
    }

    /// Adds a row.
    pub fn push(&mut self, fields: impl IntoIterator<Item = String>) -> csv::Result<()> {
        self.writer.write_record(fields.into_iter().collect::<Vec<_>>())
    }

    /// The whole table.
    pub fn finish(self) -> csv::Result<String> {
        let bytes = self.writer.into_inner().map_err(|error| std::io::Error::other(error.to_string()))?;
        Ok(self.head + &String::from_utf8_lossy(&bytes))
    }
}
