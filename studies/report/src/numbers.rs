//! Numbers → text with their units.
//!
//! The template of the page passes the fields of results by reference and computed numbers by value.

use std::borrow::Borrow;
use std::collections::BTreeSet;

use rocking_charts::numerals::{self, significant};
use rocking_studies::assess::{Counts, Report};
use rocking_studies::fragility::{Limit, split_heading};
use rocking_studies::spec::{BlockSpec, SpaceSpec, limits};

/// Writes a number with three significant digits.
pub fn short(value: impl Borrow<f64>) -> String {
    to_digits(*value.borrow(), 3)
}

fn to_digits(value: f64, digits: usize) -> String {
    match value != 0.0 && value.abs() < 1e-3 {
        true => format!("{value:.*e}", digits - 1).replace('-', "−"),
        false => significant(value, digits),
    }
}

/// Writes a number with four significant digits.
pub fn long(value: impl Borrow<f64>) -> String {
    significant(*value.borrow(), 4)
}

/// Writes a fraction in per cent.
pub fn percent(fraction: impl Borrow<f64>) -> String {
    let value = 100.0 * *fraction.borrow();
    let text =
        if value != 0.0 && value < 1e-3 { format!("{value:.1e}").replace('-', "−") } else { significant(value, 3) };
    format!("{text} %")
}

/// Writes a range with three digits, or with more if its ends would look the same; equal ends as one number. `None` without ends.
fn ends(ends: [Option<f64>; 2], write: fn(f64, usize) -> String) -> Option<String> {
    match ends {
        [None, None] => None,
        [Some(low), None] => Some(format!("above {}", write(low, 3))),
        [None, Some(high)] => Some(format!("below {}", write(high, 3))),
        [Some(low), Some(high)] if low == high => Some(write(low, 3)),
        [Some(low), Some(high)] => Some(numerals::ends([low, high], 3, write).join(" to ")),
    }
}

/// Writes an interval; an unbounded end becomes a word.
pub fn interval(interval: [Option<f64>; 2]) -> String {
    ends(interval, to_digits).unwrap_or_else(|| "unbounded".into())
}

/// Writes an annual rate (1/year).
pub fn rate(rate: impl Borrow<f64>) -> String {
    rate_to_digits(*rate.borrow(), 3)
}

fn rate_to_digits(rate: f64, digits: usize) -> String {
    rocking_charts::rate::per_year_to(rate, digits).replace('-', "−")
}

/// Writes the range of an annual rate (1/year), if it has an end.
pub fn rate_range([low, high]: [Option<f64>; 2]) -> Option<String> {
    // A lower end below the least printed rate carries no information.
    ends([low.filter(|low| *low >= rocking_charts::rate::NEGLIGIBLE), high], rate_to_digits)
}

/// Writes a return period (years).
pub fn years(years: impl Borrow<f64>) -> String {
    let years = *years.borrow();
    if years < 1e7 { significant(years, 3) } else { format!("{years:.1e}") }
}

/// Returns name and suffix of a number under a heading such as `PGV [m/s]`.
pub fn heading(heading: &str) -> (String, String) {
    let (name, unit) = split_heading(heading);
    let unit = unit.unwrap_or("1").replace('2', "²").replace('.', "·");
    let suffix = if unit == "1" { String::new() } else { format!(" {unit}") };
    (name.replace("alpha", "α"), suffix)
}

/// Returns the name of a quantity such as `eta [1]` and the suffix of its numbers. A parameter of a block has its title.
pub fn named_quantity(of: &str) -> (String, String) {
    let (name, unit) = heading(of);
    let key = split_heading(of).0;
    let title = [limits::properties::<BlockSpec>(), limits::properties::<SpaceSpec>()]
        .into_iter()
        .find_map(|parameters| parameters[key]["title"].as_str().map(String::from));
    (title.unwrap_or(name), unit)
}

/// Writes a quantity by its name and unit.
pub fn quantity(of: &str) -> String {
    let (name, unit) = named_quantity(of);
    if unit.is_empty() { name } else { format!("{name} ({})", unit.trim()) }
}

/// Writes a limit in symbols.
pub fn limit(limit: impl Borrow<Limit>) -> String {
    match limit.borrow() {
        Limit::Overturned => "overturning".into(),
        Limit::Balance => "passing the balance".into(),
        Limit::Rotation(limit) => format!("|θ|/α > {limit}"),
        Limit::Slip(limit) => format!("slip > {limit} m"),
        Limit::Plastic(limit) => format!("plastic elongation > {limit} m"),
        Limit::HalfCycles(limit) => format!("more than {limit} half cycles"),
        Limit::Breaks => "a tie or damper breaks".into(),
        Limit::Tilt(limit) => format!("tilt > {limit} of that of the balance"),
        Limit::Twist(limit) => format!("twist > {limit} rad"),
        Limit::Drift(limit) => format!("drift > {limit} m"),
    }
}

/// Returns the predicate for runs beyond a limit, as in “12 runs overturn”.
pub fn exceed(limit: Limit) -> String {
    match limit {
        Limit::Overturned => "overturn".into(),
        Limit::Balance => "pass their balance".into(),
        Limit::Rotation(limit) => format!("exceed |θ|/α = {limit}"),
        Limit::Slip(limit) => format!("overturn or slip more than {limit} m"),
        Limit::Plastic(limit) => format!("overturn or stretch a tie or damper plastically by more than {limit} m"),
        Limit::HalfCycles(limit) => format!("overturn or give a tie or damper more than {limit} half cycles"),
        Limit::Breaks => "overturn or break a tie or damper".into(),
        Limit::Tilt(limit) => format!("tilt more than {limit} of the way to the balance"),
        Limit::Twist(limit) => format!("overturn or twist more than {limit} rad"),
        Limit::Drift(limit) => format!("overturn or drift more than {limit} m"),
    }
}

/// [`ground_motions`] in fewer words.
pub fn motions(report: &Report) -> String {
    ground_motions(report).replace("ground motion", "motion")
}

/// Writes the number of ground motions, each once whatever the number of its components, directions, polarities and floors.
pub fn ground_motions(report: &Report) -> String {
    let motions = &report.motions;
    let names: BTreeSet<&str> = motions.iter().map(|motion| motion.name.as_str()).collect();
    let (count, floors) = (report.independent_motions(), report.building.as_ref().map_or(1, |of| of.stands_on.len()));
    let mut counted = counted(count as u64, "ground motion");
    let records = names.len() / floors.max(1);
    if records > count {
        counted += &format!(" in {records} components");
    }
    // Each has as many directions as all others.
    let directions = motions.len() / names.len().max(1);
    if directions > 1 {
        counted += &format!(" in {directions} directions");
    }
    if floors > 1 {
        counted += &format!(" on {floors} floors");
    }
    match report.reversed {
        0 => counted,
        all if all == motions.len() => counted + " in both polarities",
        some => counted + &format!(" ({some} also reversed)"),
    }
}

/// Writes a count with its noun.
pub fn counted(count: impl Borrow<u64>, noun: &str) -> String {
    let count = *count.borrow();
    format!("{count} {noun}{}", if count == 1 { "" } else { "s" })
}

/// Returns the predicate of an object beyond a limit without symbols, as in “the object overturns”.
pub fn exceeds_in_words(limit: Limit) -> String {
    match limit {
        Limit::Overturned => "overturns".into(),
        Limit::Balance => "passes the balance over its corner".into(),
        Limit::Rotation(limit) => {
            format!("tilts beyond {limit} times the angle at which its centre of mass stands over its corner")
        }
        Limit::Slip(limit) => format!("overturns or slips more than {limit} m"),
        Limit::Plastic(limit) => format!("overturns or stretches a tie or damper plastically by more than {limit} m"),
        Limit::HalfCycles(limit) => format!("overturns or gives a tie or damper more than {limit} half cycles"),
        Limit::Breaks => "overturns or breaks a tie or damper".into(),
        Limit::Tilt(limit) => {
            format!("tilts beyond {limit} times the angle of its balance in the direction in which it leans")
        }
        Limit::Twist(limit) => format!("overturns or twists more than {limit} rad"),
        Limit::Drift(limit) => format!("overturns or drifts more than {limit} m"),
    }
}

/// Meaning of the measures and symbols of a page.
pub const WORDS: [(&str, &str); 21] = [
    ("PGA", "peak ground acceleration: the greatest acceleration of the ground"),
    ("PGV", "peak ground velocity: the greatest velocity of the ground"),
    ("PFA", "peak floor acceleration: the greatest acceleration of the floor on which the object stands"),
    ("PFV", "peak floor velocity: the greatest velocity of that floor"),
    ("larger", "the larger value of a measure of both horizontal components"),
    ("geomean", "the geometric mean of a measure of both horizontal components"),
    ("RotD50", "the median of a measure over all horizontal directions"),
    ("RotD100", "the greatest value of a measure over all horizontal directions"),
    ("azimuth", "direction of the first component, from x towards y, seen from above"),
    ("tilt", "angle between the axis of the object and the vertical, in whatever direction"),
    (
        "tilt/α",
        "the tilt over that at which the centre of mass stands over the base's edge or corner, in the direction of the lean",
    ),
    ("α_edge", "the tilt at which the centre of mass stands over the nearest edge of the base"),
    ("twist", "rotation of the object about the vertical"),
    ("drift", "distance of the base from its place at the start"),
    ("θ", "rotation of the object about a corner of its base"),
    (
        "α",
        "slenderness: the angle between the vertical and the line from a corner to the centre of mass; at |θ|/α = 1 that centre stands over the corner",
    ),
    ("p", "frequency parameter: a measure of size, smaller for larger objects"),
    (
        "β",
        "dispersion: how widely the strengths scatter at which an object exceeds the limit, as a standard deviation of natural logarithms",
    ),
    ("median", "the strength of shaking at which the limit is exceeded with a probability of one half"),
    ("interval", "the range of values that the scatter among the ground motions allows, at the stated confidence"),
    ("μ", "coefficient of friction between feet and base"),
];

/// Returns the name of a measure, spelled out if the page has its meaning.
pub fn spelled(measure: &str) -> String {
    // `PGV.RotD50` is that of both components.
    let of_component = measure.split('.').next().unwrap_or(measure);
    let word = WORDS.iter().find(|(word, _)| *word == of_component).and_then(|(_, meaning)| meaning.split(':').next());
    word.map_or(measure.into(), |meaning| format!("{meaning} ({measure})"))
}

/// Writes where runs without a curve lie: the measure up to which none exceeds the limit, and the one from which on all do. `heading` has
/// the name and the suffix of the measure.
pub fn separate([none, all]: [Option<f64>; 2], motions: &str, (measure, unit): (&str, &str)) -> Option<String> {
    match (none, all) {
        (Some(none), Some(all)) => Some(format!(
            "no exceedance among {motions} up to a {measure} of {}{unit}, only exceedances from {}{unit} on",
            short(none),
            short(all)
        )),
        (Some(none), None) => Some(format!("no exceedance among {motions} up to a {measure} of {}{unit}", short(none))),
        (None, Some(all)) => {
            Some(format!("only exceedances among {motions} from a {measure} of {}{unit} on", short(all)))
        }
        (None, None) => None,
    }
}

/// Writes the number of runs that exceed a limit. It is a range if some have no known outcome.
pub fn exceeded(runs: &Counts) -> String {
    if runs.left_out == 0 { runs.exceeded.to_string() } else { format!("{} to {}", runs.exceeded, runs.at_most()) }
}

/// Writes the reason why runs have no curve.
pub fn no_curve(runs: &Counts, reason: &str) -> String {
    match runs.exceeded {
        0 => "no run exceeds the limit".into(),
        all if all == runs.known => "all runs exceed the limit".into(),
        _ => reason.into(),
    }
}

/// Writes a median, or the bound of the runs that it exceeds: curves are not extrapolated.
pub fn median(median: f64, [least, greatest]: [f64; 2]) -> String {
    match median {
        _ if median > greatest => format!("above {}", short(greatest)),
        _ if median < least => format!("below {}", short(least)),
        _ => short(median),
    }
}

/// Writes a slip (m), without round-off.
pub fn slip(slip: impl Borrow<f64>) -> String {
    let slip = *slip.borrow();
    if slip < 1e-6 { "0".into() } else { short(slip) }
}

#[cfg(test)]
mod tests {
    use super::*;

    /// Each limit has its own words, and only overturning is called so.
    #[test]
    fn limits_have_their_own_names() {
        let limits = ["overturned", "balance", "0.5", "slip:0.1", "plastic:0.02", "half_cycles:20", "breaks"];
        let found = limits.map(|word| (limit(word.parse::<Limit>().unwrap()), exceed(word.parse().unwrap())));
        let exact = [
            ("overturning", "overturn"),
            ("passing the balance", "pass their balance"),
            ("|θ|/α > 0.5", "exceed |θ|/α = 0.5"),
            ("slip > 0.1 m", "overturn or slip more than 0.1 m"),
            ("plastic elongation > 0.02 m", "overturn or stretch a tie or damper plastically by more than 0.02 m"),
            ("more than 20 half cycles", "overturn or give a tie or damper more than 20 half cycles"),
            ("a tie or damper breaks", "overturn or break a tie or damper"),
        ];
        assert_eq!(found, exact.map(|(limit, exceed)| (limit.to_string(), exceed.to_string())));
    }

    /// A count has its noun in the right number, and each measure of the box is spelled out.
    #[test]
    fn counts_and_measures_are_words() {
        assert_eq!([1, 2, 0].map(|count| counted(count, "block")), ["1 block", "2 blocks", "0 blocks"]);
        assert_eq!(spelled("PGV"), "peak ground velocity (PGV)");
        assert_eq!(spelled("CAV"), "CAV");
    }

    /// Two motions without an exceedance bound no rate.
    #[test]
    fn runs_without_a_curve_are_stated_as_they_are() {
        let of = |at| separate(at, "2 motions", ("PGV", " m/s"));
        assert_eq!(of([Some(1.3), None]).as_deref(), Some("no exceedance among 2 motions up to a PGV of 1.3 m/s"));
        assert_eq!(
            of([Some(0.4), Some(0.6)]).as_deref(),
            Some("no exceedance among 2 motions up to a PGV of 0.4 m/s, only exceedances from 0.6 m/s on")
        );
        assert_eq!(of([None, None]), None);
    }
}
