//! The feet of a list, from the lines of a file.

use std::path::Path;

use rocking_records::local_path;

use crate::space::FootPlace;
use crate::space::parameters::FEET;

/// Size of a file (bytes) that no list of feet reaches.
const LARGEST_FILE: u64 = 1 << 20;

/// Reads the feet of a file.
///
/// # Errors
/// One line without the path: no such file, or those of [`parse`].
pub fn read(path: &str) -> Result<Vec<FootPlace>, String> {
    let path = local_path(Path::new(path)).map_err(|error| error.to_string())?;
    let found = std::fs::metadata(&path).map_err(|error| error.to_string())?;
    if !found.is_file() || found.len() > LARGEST_FILE {
        return Err(format!("found no file of at most {LARGEST_FILE} bytes; expected one with a line for each foot"));
    }
    parse(&std::fs::read_to_string(&path).map_err(|error| error.to_string())?)
}

/// Reads lines of two or three numbers (m): x and y from the centre of mass, and the gap. Commas, semicolons and blanks separate them, `#`
/// begins a comment.
///
/// # Errors
/// The first line that is none, or more feet than a block has.
pub fn parse(text: &str) -> Result<Vec<FootPlace>, String> {
    let mut feet = Vec::new();
    for (number, line) in (1..).zip(text.lines()) {
        let line = line.split('#').next().unwrap_or_default();
        let words = line.split(|c: char| c.is_whitespace() || c == ',' || c == ';').filter(|word| !word.is_empty());
        let numbers: Result<Vec<f64>, _> = words.map(str::parse).collect();
        match numbers.as_deref() {
            Ok([]) => {}
            Ok(&[x, y]) => feet.push(FootPlace { x, y, gap: 0.0 }),
            Ok(&[x, y, gap]) => feet.push(FootPlace { x, y, gap }),
            Ok(_) | Err(_) => {
                return Err(format!("line {number} is {:?}; expected x, y and, if any, a gap in m", line.trim()));
            }
        }
        if feet.len() > FEET[1] {
            return Err(format!("line {number} has foot {}; expected at most {}", feet.len(), FEET[1]));
        }
    }
    Ok(feet)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn lines_have_two_or_three_numbers() {
        let feet = parse("# x, y, gap\n-1, -0.5\n1;0.5 0.01 # stands clear\n\n").unwrap();
        assert_eq!(feet, [FootPlace { x: -1.0, y: -0.5, gap: 0.0 }, FootPlace { x: 1.0, y: 0.5, gap: 0.01 }]);
        let refuse = |text: &str, words: &str| assert_eq!(parse(text).unwrap_err(), words);
        refuse("1 2\nx y\n", "line 2 is \"x y\"; expected x, y and, if any, a gap in m");
        refuse("1 2 3 4\n", "line 1 is \"1 2 3 4\"; expected x, y and, if any, a gap in m");
        refuse(&"1 2\n".repeat(65), "line 65 has foot 65; expected at most 64");
    }
}
