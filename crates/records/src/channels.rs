//! File of several channels → the lines of one.

use super::error::RecordError;
use super::options::Setting;
use super::text::{FileText, is_end_mark, squeezed};

/// Returns the numbered lines of the wanted channel (from 1); a file of several channels needs a choice.
///
/// Every channel ends with a line such as `/&  ----------  END OF DATA FOR CHANNEL  1  ----------`.
pub(super) fn choose<'s>(
    source: &'s FileText<'_>,
    wanted: Option<usize>,
) -> Result<Vec<(usize, &'s str)>, RecordError> {
    let mut channels: Vec<Vec<(usize, &str)>> = vec![Vec::new()];
    let mut ended = false;
    for (line, text) in source.lines() {
        if ended && !text.trim().is_empty() {
            channels.push(Vec::new());
            ended = false;
        }
        ended |= is_end_mark(text);
        if let Some(channel) = channels.last_mut() {
            channel.push((line, text));
        }
    }
    let count = channels.len();
    let index = match (wanted, count) {
        (Some(wanted), _) => wanted.checked_sub(1),
        (None, 1) => Some(0),
        (None, _) => None,
    };
    if let Some(channel) = index.filter(|&index| index < count).map(|index| channels.swap_remove(index)) {
        return Ok(channel);
    }
    let first_lines: Vec<String> = channels
        .iter()
        .filter_map(|lines| lines.first())
        .zip(1..=9)
        .map(|((_, text), number)| format!("{number}: {}", squeezed(text).chars().take(70).collect::<String>()))
        .collect();
    let asked = wanted.map_or(String::new(), |wanted| format!(", not channel {wanted}"));
    let found =
        format!("found {count} channel{} ({}){asked}", if count == 1 { "" } else { "s" }, first_lines.join(", "));
    let expected = if count == 1 { "1".into() } else { format!("1 to {count}") };
    Err(source.needs_setting(None, found, Setting::Channel, expected))
}
