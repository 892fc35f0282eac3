//! File of several channels → the one that the caller wants.

use super::error::RecordError;
use super::options::{Choice, Setting};
use super::text::{FileText, first_of, is_end_mark, squeezed};

/// Numbered lines of a channel.
pub(super) type Lines<'s> = Vec<(usize, &'s str)>;

/// Longest shown name of a channel.
const LONGEST_NAME: usize = 70;

/// Returns the index of the wanted channel; a file of several channels needs a choice.
pub(super) fn index(
    source: &FileText<'_>,
    names: &[impl AsRef<str>],
    wanted: Option<&Choice>,
) -> Result<usize, RecordError> {
    let names: Vec<&str> = names.iter().map(AsRef::as_ref).collect();
    let count = names.len();
    let named = |name: &str| {
        let mut equal = (0..count).filter(|&index| names.get(index).is_some_and(|n| n.eq_ignore_ascii_case(name)));
        equal.next().filter(|_| equal.next().is_none())
    };
    let index = match wanted {
        Some(Choice::Number(number)) => number.checked_sub(1).filter(|index| index < &count),
        Some(Choice::Name(name)) => named(name.trim()),
        None => (count == 1).then_some(0),
    };
    index.ok_or_else(|| {
        let shown = (1..).zip(names).map(|(number, name)| format!("{number}: {name}")).collect::<Vec<_>>();
        let shown = first_of(&shown);
        let asked = wanted.map_or(String::new(), |wanted| format!(", not one {}", wanted.described("channel")));
        let found = format!("found {count} channel{} ({shown}){asked}", if count == 1 { "" } else { "s" });
        let expected = if count == 1 { "1 or its name".into() } else { format!("1 to {count} or a name") };
        source.needs_setting(None, found, Setting::Channel, expected)
    })
}

/// Returns the lines of the wanted channel, in a file whose channels follow each other.
///
/// Every channel ends with a line such as `/&  ----------  END OF DATA FOR CHANNEL  1  ----------`. `name` returns the name
/// of a channel; one without is shown by its first line.
pub(super) fn choose<'s>(
    source: &'s FileText<'_>,
    wanted: Option<&Choice>,
    name: impl Fn(&[(usize, &str)]) -> Option<String>,
) -> Result<Lines<'s>, RecordError> {
    let mut channels: Vec<Lines> = vec![Vec::new()];
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
    let first_line = |lines: &Lines| squeezed(lines.first().map_or("", |(_, text)| text));
    let names: Vec<String> = channels
        .iter()
        .map(|lines| name(lines).unwrap_or_else(|| first_line(lines)).chars().take(LONGEST_NAME).collect())
        .collect();
    Ok(channels.swap_remove(index(source, &names, wanted)?))
}

/// Returns the name in a line such as `Chan  1:  90 Deg      (Sta Chn:  1)`, or in `Sta Chan  1: 340 deg (Rcrdr Chan  1)`.
pub(super) fn name_after_number(text: &str) -> Option<String> {
    let (start, name) = text.split_once(':')?;
    let mut words = start.split_whitespace().skip_while(|word| word.eq_ignore_ascii_case("sta"));
    words.next().and_then(|word| word.get(..3)).filter(|word| word.eq_ignore_ascii_case("cha"))?;
    // "Sta Cha:  1: 340 deg" has the number behind the colon.
    let number = name.split_once(':').filter(|(number, _)| number.trim().bytes().all(|byte| byte.is_ascii_digit()));
    let name = number.map_or(name, |(_, name)| name).split('(').next().map(squeezed)?;
    (!name.is_empty()).then_some(name)
}
