//! The list of cargo-mutants → mutants with their places in the sources.

use serde::Deserialize;

/// A change of the sources.
pub struct Mutant {
    /// Its number in the list, from 1.
    pub number: u32,
    pub file: String,
    /// Name of the function around it, or empty.
    pub function: String,
    /// Description of the change.
    pub change: String,
    pub genre: Genre,
    /// The text that it replaces.
    pub span: Span,
    pub replacement: String,
}

impl Mutant {
    /// Returns file, line and column.
    pub fn place(&self) -> String {
        format!("{}:{}:{}", self.file, self.span.start.line, self.span.start.column)
    }
}

#[derive(Clone, Copy, Deserialize, PartialEq, Eq, PartialOrd, Ord)]
pub enum Genre {
    FnValue,
    BinaryOperator,
    UnaryOperator,
    MatchArm,
    MatchArmGuard,
    StructField,
}

/// The text between two places.
#[derive(Clone, Copy, Deserialize)]
pub struct Span {
    pub start: Place,
    pub end: Place,
}

/// Line and column in characters, both from 1.
#[derive(Clone, Copy, Deserialize)]
pub struct Place {
    pub line: usize,
    pub column: usize,
}

#[derive(Deserialize)]
struct Entry {
    name: String,
    file: String,
    function: Option<Function>,
    genre: Genre,
    span: Span,
    replacement: String,
}

#[derive(Deserialize)]
struct Function {
    function_name: String,
}

pub fn read(text: &str) -> Result<Vec<Mutant>, String> {
    let entries: Vec<Entry> = serde_json::from_str(text).map_err(|e| format!("the list of mutants: {e}"))?;
    let mutants = (1..).zip(entries).map(|(number, entry)| Mutant {
        number,
        // The name begins with file, line and column.
        change: entry.name.split_once(": ").map_or(&*entry.name, |(_, change)| change).to_string(),
        file: entry.file,
        function: entry.function.map_or_else(String::new, |function| function.function_name),
        genre: entry.genre,
        span: entry.span,
        replacement: entry.replacement,
    });
    Ok(mutants.collect())
}
