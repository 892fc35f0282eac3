//! Text of a header, options → quantity, unit and time step of the values.
//!
//! A header may state unit and step in many forms: `Accelerations in g`, `# Unidades: m/seg/seg`, `FLOAT, M/S`, `100 sps`,
//! `dt = 0.01`. Everything that its text claims is collected here, and one rule settles it with the options: an option is among the
//! claims, without an option the claims agree, and a quantity other than acceleration is refused. The heading of the column that is read and
//! the fields of a known format are definite and precede the claims of the text.

use super::error::RecordError;
use super::options::{ReadOptions, Setting};
use super::text::{FileText, number, quoted};
use super::unit::{Quantity, Unit, other_quantity};

/// Relative difference below which two time steps are equal; no header prints more digits.
pub(super) const SAME_STEP: f64 = 1e-6;

/// Time step of a file.
pub(super) struct StatedStep {
    pub(super) line: usize,
    /// (s)
    pub(super) value: f64,
    /// Tolerance for the caller's time step [s].
    pub(super) tolerance: f64,
}

impl StatedStep {
    /// A time step printed in the header.
    pub(super) fn exact(line: usize, value: f64) -> StatedStep {
        StatedStep { line, value, tolerance: SAME_STEP * value.abs() }
    }
}

/// Statement of a header.
pub(super) struct Claim {
    line: usize,
    /// The whole line.
    text: String,
    kind: Kind,
}

#[derive(Clone, Copy, PartialEq)]
enum Kind {
    Unit(Unit),
    /// Another quantity, or a unit that is not read.
    Other(Quantity),
    /// Units without a known one.
    Unknown,
    /// Time step (s).
    Step(f64),
}

impl Claim {
    /// Claims a quantity other than acceleration in a line.
    pub(super) fn other(line: usize, text: &str, quantity: Quantity) -> Claim {
        Claim { line, text: text.to_owned(), kind: Kind::Other(quantity) }
    }
}

/// Collects the claims of lines of text.
pub(super) fn of_text<'s>(lines: impl Iterator<Item = (usize, &'s str)>) -> Vec<Claim> {
    let of_line = |(line, text): (usize, &'s str)| {
        let tokens = tokens(text);
        let kinds = units(&tokens).into_iter().chain(step(&tokens).map(Kind::Step));
        kinds.map(move |kind| Claim { line, text: text.to_owned(), kind }).collect::<Vec<_>>()
    };
    lines.flat_map(of_line).collect()
}

/// Settles the unit of the values, with the line that states it. `stated` is definite.
pub(super) fn unit(
    source: &FileText<'_>,
    stated: Option<(usize, Unit)>,
    claims: &[Claim],
    options: &ReadOptions,
) -> Result<(Option<usize>, Unit), RecordError> {
    let given = options.unit;
    let but = given.map_or(String::new(), |unit| format!(" but {unit} was given"));
    if stated.is_none() {
        for Claim { line, text, kind } in claims {
            match kind {
                // The caller's value of a printed 1 converts readings of instruments and unusual units.
                Kind::Other(quantity) if !(quantity.is_convertible() && options.value_scale.is_some()) => {
                    return Err(source.not_acceleration(*line, format!("{quantity} ({}){but}", quoted(text))));
                }
                Kind::Unknown => return Err(source.header_error(*line, text, "a unit among g, m/s2, cm/s2")),
                Kind::Other(_) | Kind::Unit(_) | Kind::Step(_) => {}
            }
        }
    }
    let claimed = claims.iter().filter_map(|claim| match claim.kind {
        Kind::Unit(unit) => Some((claim.line, unit)),
        Kind::Other(_) | Kind::Unknown | Kind::Step(_) => None,
    });
    let found: Vec<(usize, Unit)> = stated.map_or_else(|| claimed.collect(), |stated| vec![stated]);
    let Some(&(line, unit)) = found.first() else {
        let found = "no unit in the file and none given";
        let given = given.map(|unit| (None, unit));
        return given.ok_or_else(|| source.needs_setting(None, found, Setting::Unit, "g, m/s2 or cm/s2"));
    };
    let contradicts = |found: String, expected: Unit| {
        source.needs_setting(Some(line), found, Setting::Unit, expected.to_string().replace('²', "2"))
    };
    match given {
        Some(given) => match found.iter().find(|(_, unit)| *unit == given) {
            Some(&(line, unit)) => Ok((Some(line), unit)),
            None => Err(contradicts(format!("the file is in {unit} but {given} was given"), unit)),
        },
        None => match found.iter().find(|(_, other)| *other != unit) {
            Some((other_line, other)) => {
                let found = format!("the header states {unit}, and {other} in line {other_line}");
                Err(source.needs_setting(Some(line), found, Setting::Unit, "to choose one"))
            }
            None => Ok((Some(line), unit)),
        },
    }
}

/// Settles the time step (s). `stated` is definite.
pub(super) fn time_step(
    source: &FileText<'_>,
    stated: Option<StatedStep>,
    claims: &[Claim],
    given: Option<f64>,
) -> Result<f64, RecordError> {
    let claimed = claims.iter().filter_map(|claim| match claim.kind {
        Kind::Step(value) => Some(StatedStep::exact(claim.line, value)),
        Kind::Other(_) | Kind::Unknown | Kind::Unit(_) => None,
    });
    let found: Vec<StatedStep> = stated.map_or_else(|| claimed.collect(), |stated| vec![stated]);
    let Some(StatedStep { line, value, tolerance }) = found.first() else {
        let found = "no time step in the file and none given";
        return given.ok_or_else(|| source.needs_setting(None, found, Setting::TimeStep, "in seconds"));
    };
    if !(value.is_finite() && *value > 0.0) {
        return Err(source.header_error(*line, &format!("time step {value} s"), "a time step above 0 s"));
    }
    match given {
        Some(given) if found.iter().any(|step| (given - step.value).abs() <= step.tolerance) => Ok(given),
        Some(given) => {
            let found = format!("the file has a time step of {value} s but {given} s was given");
            Err(source.needs_setting(Some(*line), found, Setting::TimeStep, value.to_string()))
        }
        None => match found.iter().find(|step| (step.value - value).abs() > *tolerance) {
            Some(other) => {
                let found = format!(
                    "the header states a time step of {value} s, and of {} s in line {}",
                    other.value, other.line
                );
                Err(source.needs_setting(Some(*line), found, Setting::TimeStep, "to choose one"))
            }
            None => Ok(*value),
        },
    }
}

/// Beginnings of the word for an acceleration in the languages of networks, without accents.
const ACCELERATION: [&str; 3] = ["acc", "acel", "beschleunigung"];

const OTHERS: [(Quantity, &[&str]); 2] = [
    (Quantity::Velocity, &["velocit", "velocidad", "vitesse", "geschwindigkeit"]),
    (Quantity::Displacement, &["displacement", "desplazamiento", "deplacement", "spostament", "verschiebung"]),
];

/// Words after a quantity that make it the content of the file.
const CONTENT: [&str; 11] =
    ["time", "history", "histories", "series", "record", "records", "data", "trace", "seismogram", "in", "en"];

/// Words before a unit of all values.
const UNIT_KEYS: [&str; 11] =
    ["unit", "units", "unidad", "unidades", "einheit", "einheiten", "unite", "unites", "unita", "birim", "unidade"];

/// Words before a time step, without accents.
const STEP_KEYS: [&str; 27] = [
    "dt",
    "delta t",
    "deltat",
    "time step",
    "timestep",
    "time interval",
    "sampling interval",
    "sampling int",
    "sample interval",
    "sampling period",
    "sample period",
    "sampling step",
    "sample spacing",
    "sample step",
    "time spacing",
    "equal spacing of",
    "equally spaced at",
    "spaced at",
    "intervals of",
    "zeitschritt",
    "abtastintervall",
    "intervalo de muestreo",
    "periodo de muestreo",
    "paso de tiempo",
    "pas de temps",
    "intervallo di campionamento",
    "passo temporale",
];

/// Words before a sampling rate, without accents.
const RATE_KEYS: [&str; 15] = [
    "sampling rate",
    "sample rate",
    "samplerate",
    "sampling frequency",
    "sampling freq",
    "sample frequency",
    "sample freq",
    "samples per second",
    "tasa de muestreo",
    "frecuencia de muestreo",
    "abtastrate",
    "abtastfrequenz",
    "frequence d echantillonnage",
    "frequenza di campionamento",
    "fs",
];

/// Piece of a line.
#[derive(Clone, PartialEq)]
enum Token {
    Word(String),
    Number(f64),
    Mark(char),
}

use Token::{Mark, Number, Word};

impl Token {
    fn word(&self) -> Option<&str> {
        match self {
            Word(word) => Some(word),
            Number(_) | Mark(_) => None,
        }
    }

    fn is_word_of(&self, words: &[&str]) -> bool {
        self.word().is_some_and(|word| words.contains(&word))
    }
}

/// Splits a line into words in lower case without accents, numbers and marks.
fn tokens(text: &str) -> Vec<Token> {
    let plain: String = text.to_lowercase().chars().filter_map(without_accent).collect();
    // A unit may have blanks around its stroke.
    let plain = plain.replace(" /", "/").replace("/ ", "/");
    let chars: Vec<char> = plain.chars().collect();
    let near = |index: usize, step: isize| index.checked_add_signed(step).and_then(|index| chars.get(index)).copied();
    let beside = |index: usize, is: fn(char) -> bool| near(index, -1).is_some_and(is) && near(index, 1).is_some_and(is);
    let mut tokens = Vec::new();
    let mut word = String::new();
    for (index, &c) in chars.iter().enumerate() {
        match c {
            // Decimal comma.
            ',' if beside(index, |c| c.is_ascii_digit()) => word.push('.'),
            '_' | '\'' | '-' if c != '-' || beside(index, char::is_alphabetic) => flush(&mut word, &mut tokens),
            ',' | ';' | ':' | '=' | '(' | ')' | '[' | ']' | '{' | '}' | '"' | '&' | '|' | '#' | '<' | '>' => {
                flush(&mut word, &mut tokens);
                tokens.push(Mark(c));
            }
            c if c.is_whitespace() => flush(&mut word, &mut tokens),
            c => word.push(c),
        }
    }
    flush(&mut word, &mut tokens);
    tokens
}

/// Ends a word. A number keeps no unit behind it, as `0.005s`.
fn flush(word: &mut String, tokens: &mut Vec<Token>) {
    let whole = std::mem::take(word);
    let trimmed = whole.trim_end_matches('.');
    if trimmed.is_empty() {
        return;
    }
    let fraction = |text: &str| {
        let (above, below) = text.split_once('/')?;
        Some(number(above)? / number(below)?)
    };
    if let Some(value) = number(&whole).or_else(|| fraction(trimmed)).filter(|value| value.is_finite()) {
        tokens.push(Number(value));
        return;
    }
    let digits = trimmed.len() - trimmed.trim_start_matches(|c: char| c.is_ascii_digit() || c == '.').len();
    let (front, rest) = trimmed.split_at(digits);
    match number(front).filter(|_| rest.starts_with(|c: char| c.is_alphabetic())) {
        Some(value) => tokens.extend([Number(value), Word(rest.to_owned())]),
        None => tokens.push(Word(trimmed.to_owned())),
    }
}

/// Removes the accent of a letter of western European languages.
fn without_accent(c: char) -> Option<char> {
    Some(match c {
        'á' | 'à' | 'â' | 'ä' | 'ã' => 'a',
        'é' | 'è' | 'ê' | 'ë' => 'e',
        'í' | 'ì' | 'î' | 'ï' => 'i',
        'ó' | 'ò' | 'ô' | 'ö' | 'õ' => 'o',
        'ú' | 'ù' | 'û' | 'ü' => 'u',
        'ñ' => 'n',
        'ç' => 'c',
        // Left in decomposed letters.
        '\u{300}'..='\u{36f}' => return None,
        c => c,
    })
}

/// Returns the claims of a line on the values: their unit, or another quantity.
///
/// A line with an acceleration claims no other quantity, since it may name several columns or blocks.
fn units(tokens: &[Token]) -> Vec<Kind> {
    let token = |place: Option<usize>| place.and_then(|place| tokens.get(place));
    let is_mark =
        |place: Option<usize>, marks: &[char]| matches!(token(place), Some(Mark(mark)) if marks.contains(mark));
    let is_number = |place: Option<usize>| matches!(token(place), Some(Number(_)));
    let word_of = |starts: &[&str]| {
        tokens
            .iter()
            .position(|token| token.word().is_some_and(|word| starts.iter().any(|start| word.starts_with(start))))
    };
    let names_acceleration = word_of(&ACCELERATION).is_some();
    let names_displacement =
        OTHERS.iter().any(|(quantity, starts)| *quantity == Quantity::Displacement && word_of(starts).is_some());
    let key = tokens.iter().position(|token| token.is_word_of(&UNIT_KEYS));
    let mut kinds = Vec::new();
    for (index, word) in tokens.iter().enumerate().filter_map(|(index, token)| Some((index, token.word()?))) {
        let kind = match (word.parse::<Unit>(), other_quantity(word)) {
            (Ok(unit), _) => Kind::Unit(unit),
            (Err(_), Some(quantity)) => Kind::Other(quantity),
            (Err(_), None) => continue,
        };
        let (before, after) = (index.checked_sub(1), Some(index + 1));
        let in_brackets = is_mark(before, &['(', '[']) && is_mark(after, &[')', ']']);
        let keyed = key.is_some_and(|key| key < index);
        // The unit of a value, as "0.3 g", "PGA (g): 0.3", "PGV_CM/S: 3".
        let (front, behind) = if in_brackets { (index.checked_sub(2), index + 2) } else { (before, index + 1) };
        let has_value = is_number(Some(behind)) || is_mark(Some(behind), &[':', '=']) && is_number(Some(behind + 1));
        // The preposition.
        let is_in = word == "in" && !in_brackets && token(after).is_some();
        if is_number(front) || has_value && !keyed || is_in {
            continue;
        }
        let says = match kind {
            Kind::Other(Quantity::Displacement) => in_brackets && names_displacement,
            // Words that mean nothing else.
            _ if word.contains('/') || word.contains("s-2") || word.starts_with("gal") => true,
            _ => {
                let alone = tokens.iter().all(|token| token.word().is_none_or(|other| other == word));
                let is_in_unit = token(before).is_some_and(|before| before.is_word_of(&["in", "en", "of"]));
                let is_listed = is_mark(before, &[',', ':', '=']) && (names_acceleration || word != "g");
                in_brackets || alone || is_in_unit || is_listed
            }
        };
        if keyed || says {
            kinds.push(kind);
        }
    }
    for (quantity, starts) in OTHERS.iter().filter(|_| !names_acceleration) {
        let Some(index) = word_of(starts) else { continue };
        let is_content = token(Some(index + 1)).is_some_and(|next| next.is_word_of(&CONTENT));
        let before = index.checked_sub(1);
        let is_value = token(Some(index + 1)).is_none() && (before.is_none() || matches!(token(before), Some(Mark(_))));
        if is_content || is_value {
            kinds.push(Kind::Other(*quantity));
        }
    }
    if kinds.iter().any(|kind| matches!(kind, Kind::Unit(_))) {
        kinds.retain(|kind| matches!(kind, Kind::Unit(_)));
    }
    let announces = key.is_some_and(|key| {
        let plural = ["units", "unidades", "einheiten", "unites"];
        let leads = is_mark(Some(key + 1), &[':', '='])
            || token(Some(key + 1)).is_some_and(|next| next.is_word_of(&["of", "are"]));
        let others = ["s", "sec", "second", "seconds", "hz", "deg", "degree", "degrees", "km"];
        let of_others = tokens.iter().skip(key).any(|token| token.is_word_of(&others));
        token(Some(key)).is_some_and(|key| key.is_word_of(&plural))
            && leads
            && !of_others
            && token(Some(key + 2)).is_some_and(|value| value.word().is_some())
    });
    if kinds.is_empty() && announces {
        kinds.push(Kind::Unknown);
    }
    kinds
}

/// Returns the time step (s) that a line claims.
fn step(tokens: &[Token]) -> Option<f64> {
    let has = |index: usize, words: &[&str]| tokens.get(index).is_some_and(|token| token.is_word_of(words));
    // "100 sps", "200 muestras/seg"
    let of_rate = tokens.iter().enumerate().find_map(|(index, token)| match token {
        Number(rate) => {
            let per_second = ["samples/s", "samples/sec", "samples/second", "muestras/seg", "muestras/s", "sps"];
            let spelled =
                has(index + 1, &["samples"]) && has(index + 2, &["per"]) && has(index + 3, &["second", "sec"]);
            (has(index + 1, &per_second) || spelled).then_some(1.0 / rate)
        }
        Word(_) | Mark(_) => None,
    });
    let keyed = || {
        let (after, is_rate) = STEP_KEYS
            .iter()
            .map(|key| (key, false))
            .chain(RATE_KEYS.iter().map(|key| (key, true)))
            .find_map(|(key, is_rate)| Some((position_after(tokens, key)?, is_rate)))?;
        let filler =
            ["is", "of", "in", "the", "at", "s", "sec", "secs", "second", "seconds", "ms", "msec", "hz", "sps"];
        let rest = tokens.get(after..)?;
        let place = rest.iter().position(|token| !matches!(token, Mark(_)) && !token.is_word_of(&filler))?;
        let Some(Number(value)) = rest.get(place) else { return None };
        let units: Vec<&str> = rest.get(..place + 2).unwrap_or(rest).iter().filter_map(Token::word).collect();
        let says = |words: &[&str]| units.iter().any(|unit| words.contains(unit));
        let is_step = says(&["s", "sec", "secs", "second", "seconds", "ms", "msec"]);
        let is_rate = says(&["hz", "sps"]) || !is_step && is_rate && *value >= 1.0;
        let milli = if says(&["ms", "msec"]) { 1e-3 } else { 1.0 };
        Some(if is_rate { 1.0 / value } else { milli * value })
    };
    of_rate.or_else(keyed).filter(|step| step.is_finite() && *step > 0.0)
}

/// Returns the index after the words of a key.
fn position_after(tokens: &[Token], key: &str) -> Option<usize> {
    let words: Vec<&str> = key.split(' ').collect();
    let fits = |window: &[Token]| window.iter().zip(&words).all(|(token, word)| token.word() == Some(word));
    tokens.windows(words.len()).position(fits).map(|index| index + words.len())
}
