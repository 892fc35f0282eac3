//! A portfolio → its page, its table and its lines on a terminal.

use askama::Template;

use crate::ReportError;
use crate::numbers::{self, counted, exceed, named_quantity, percent, rate, short, years};
use rocking_charts::picture::{PictureError, PictureFormat};
use rocking_charts::ranking::{RankedRate, ranking};
use rocking_studies::assess::{Counts, RateResult};
use rocking_studies::output::csv::with_headings;
use rocking_studies::output::table::{Table, TableColumn};
use rocking_studies::portfolio::{Help, Portfolio, RankedObject};

/// Name of the page of a portfolio.
pub const PORTFOLIO_PAGE: &str = "portfolio.html";
/// Name of its table.
const TABLE: &str = "portfolio.csv";
/// Share of a rate beyond the runs or the hazard that is named.
const NOTABLE: f64 = 0.01;

/// Name of the chart of its rates.
const PICTURE: &str = "ranking.png";

/// Makes the page, the table and the chart of a portfolio, with their names. The page links to `NAME/report.html` of each object.
///
/// # Errors
/// None in practice: all results can be written.
pub fn portfolio_files(portfolio: &Portfolio) -> Result<Vec<(String, Vec<u8>)>, ReportError> {
    let picture = picture(portfolio)?;
    let page = PortfolioPage { portfolio, picture: picture.as_deref(), version: env!("CARGO_PKG_VERSION") }.render()?;
    let mut files = vec![(PORTFOLIO_PAGE.into(), page.into_bytes()), (TABLE.into(), table(portfolio)?.into_bytes())];
    if let Some(svg) = &picture {
        files.push((PICTURE.into(), PictureFormat::Png.encode(svg)?));
    }
    Ok(files)
}

#[derive(Template)]
#[template(path = "portfolio.html")]
struct PortfolioPage<'a> {
    portfolio: &'a Portfolio,
    picture: Option<&'a str>,
    version: &'static str,
}

impl PortfolioPage<'_> {
    fn sentences(&self) -> Vec<String> {
        sentences(self.portfolio)
    }

    /// The page of an object, relative to this one. A name may have characters that an address has not.
    fn link(&self, object: &RankedObject) -> String {
        let plain = |byte: &u8| byte.is_ascii_alphanumeric() || b"-._~".contains(byte);
        let encoded = |byte: u8| if plain(&byte) { char::from(byte).to_string() } else { format!("%{byte:02X}") };
        format!("{}/{}", object.name.bytes().map(encoded).collect::<String>(), crate::PAGE)
    }

    fn rank(&self, object: &RankedObject) -> String {
        rank(object)
    }

    fn place(&self, object: &RankedObject) -> Option<String> {
        place(object)
    }

    fn state_rate(&self, object: &RankedObject) -> String {
        object.rate().map_or_else(|| "—".into(), rate)
    }

    fn interval(&self, object: &RankedObject) -> String {
        interval(object)
    }

    fn probability(&self, object: &RankedObject) -> String {
        object.state.rate.map_or_else(|| "—".into(), |found| percent(found.probability))
    }

    fn first(&self, object: &RankedObject) -> String {
        first(object)
    }

    fn helps(&self, object: &RankedObject) -> String {
        helps(object)
    }

    fn unknown(&self, object: &RankedObject) -> String {
        unknown(object).join("; ")
    }
}

/// Draws the rates in their order, if two objects have one.
fn picture(portfolio: &Portfolio) -> Result<Option<String>, PictureError> {
    let rate = |object: &RankedObject| {
        let found = object.state.rate?;
        Some(RankedRate { name: object.title.clone(), rate: found.rate, interval: found.rate_interval })
    };
    ranking(&portfolio.objects.iter().filter_map(rate).collect::<Vec<_>>(), portfolio.confidence)
}

/// Writes a rank with the range that the intervals allow.
fn rank(object: &RankedObject) -> String {
    match (object.rank, object.ranks) {
        (Some(rank), Some([low, high])) if low < high => format!("{rank} ({low} to {high})"),
        (Some(rank), _) => rank.to_string(),
        (None, _) => "—".into(),
    }
}

fn place(object: &RankedObject) -> Option<String> {
    let floor = |floor: &usize| if *floor == 0 { "the ground".into() } else { format!("floor {floor}") };
    let floors: Vec<String> = object.floors.iter().map(floor).collect();
    let period = object.building_period?;
    Some(format!("on {}, T₁ = {} s", floors.join(", "), short(period)))
}

/// Writes the interval of a rate, over all outcomes of runs without a known one.
fn interval(object: &RankedObject) -> String {
    let of = |found: RateResult| numbers::rate_range(found.rate_interval).unwrap_or_else(|| "unbounded".into());
    object.state.rate.map_or_else(|| "—".into(), of)
}

fn first(object: &RankedObject) -> String {
    match &object.first {
        Some(first) => format!("{}: {}", first.name, rate(first.rate)),
        None if object.rate().is_some() => "the same".into(),
        None => "—".into(),
    }
}

/// Names the variants that help, with the rate or the runs of each.
fn helps(object: &RankedObject) -> String {
    let one = |help: &Help| {
        let effect = match help.rates {
            _ if help.runs.at_most() == 0 => format!("none of {} runs {}", help.runs.all(), exceed(help.limit)),
            Some([low, high]) if low == high => rate(low),
            Some(range) => numbers::rate_range(range.map(Some)).unwrap_or_default(),
            None => {
                format!("{} of {} runs {}", numbers::exceeded(&help.runs), help.runs.all(), exceed(help.limit))
            }
        };
        let slip = help.peak_slip.filter(|slip| *slip > 0.0);
        let slip = slip.map(|slip| format!(", but slips up to {} m", numbers::slip(slip))).unwrap_or_default();
        format!("{}: {effect}{slip}", help.variant)
    };
    match object.helps.as_slice() {
        [] => "no variant that was tried".into(),
        helps => helps.iter().map(one).collect::<Vec<_>>().join("; "),
    }
}

/// Says what is not known of an object.
fn unknown(object: &RankedObject) -> Vec<String> {
    let state = &object.state;
    let mut unknown = Vec::new();
    match (state.rate, &object.report.hazard, &state.no_curve) {
        (Some(found), ..) => {
            if found.rate_interval[1].is_none() {
                unknown.push(format!(
                    "how much greater the rate may be: {} bound nothing",
                    counted(object.motions as u64, "motion")
                ));
            }
            let beyond = [
                (found.above_runs, "motions stronger than the runs"),
                (found.below_runs, "motions weaker than the runs"),
                (found.outside_hazard, "beyond the hazard curve"),
            ];
            let beyond = beyond.into_iter().filter(|(share, _)| *share >= NOTABLE);
            unknown.extend(beyond.map(|(share, of)| format!("{:.0}\u{a0}% of the rate, from {of}", 100.0 * share)));
        }
        (None, None, _) => unknown.push("the rate: the study names no hazard".into()),
        (None, Some(_), Some(reason)) => {
            unknown.push(format!("the rate: {}", numbers::no_curve(&state.runs, reason)));
        }
        (None, Some(_), None) => unknown.push("the rate".into()),
    }
    match state.runs.left_out {
        0 => (),
        runs => unknown.push(format!("the outcome of {}", counted(runs as u64, "run"))),
    }
    if let Some(matter) = &object.matters {
        let (name, unit) = named_quantity(&matter.name);
        let [low, high] = matter.values.map(short);
        let runs = matter.runs.each_ref().map(numbers::exceeded);
        unknown.push(format!(
            "{name}, which matters most: {} runs {} with {low}{unit}, {} with {high}{unit}",
            runs[0],
            exceed(matter.limit),
            runs[1]
        ));
    }
    if let Some(remarks) = Some(object.report.remarks.len()).filter(|remarks| *remarks > 0) {
        unknown.push(format!("{} on its page", counted(remarks as u64, "remark")));
    }
    unknown
}

/// The sentences above the table.
fn sentences(portfolio: &Portfolio) -> Vec<String> {
    let Portfolio { objects, hazard, years: period, together, has_same_motions, refused, .. } = portfolio;
    let ranked: Vec<&RankedObject> = objects.iter().filter(|object| object.rank.is_some()).collect();
    let mut sentences = Vec::new();
    if let (Some(first), Some(rate)) = (ranked.first(), ranked.first().and_then(|first| first.rate())) {
        sentences.push(format!(
            "“{}” comes first: “{}” once in {} years.",
            first.title,
            first.state.name,
            years(1.0 / rate)
        ));
    }
    if let Some(together) = together {
        sentences.push(format!(
            "The rates of {} add up to {} per year: on average one of them reaches its limit in {} years, often several in one earthquake.",
            counted(ranked.len() as u64, "object"),
            rate(together),
            years(1.0 / together)
        ));
    }
    match hazard {
        Some(hazard) => {
            sentences.push(format!("One hazard for all, {}; probabilities in {period} years.", hazard.file))
        }
        None => sentences.push("No study names a hazard, so that the objects have no rates and no order.".into()),
    }
    let without = objects.iter().filter(|object| object.rank.is_none() && object.state.runs.exceeded > 0);
    sentences.extend(without.map(|object| {
        format!(
            "“{}” has no rate and thus no rank: {} of {} runs {}.",
            object.title,
            numbers::exceeded(&object.state.runs),
            object.state.runs.all(),
            exceed(object.state.limit)
        )
    }));
    let uncertain = ranked.iter().filter(|object| object.ranks.is_some_and(|[low, high]| low < high)).count();
    if uncertain > 0 && ranked.len() > 1 {
        sentences.push(format!(
            "The order is uncertain: by the intervals of the rates, {uncertain} of {} ranks may be others, as in parentheses.",
            ranked.len()
        ));
    }
    let mut limits: Vec<_> = objects.iter().map(|object| object.state.limit.to_string()).collect();
    limits.sort();
    limits.dedup();
    if limits.len() > 1 {
        sentences
            .push("The limits differ: each object is ranked by the most severe state that its study names.".into());
    }
    if !has_same_motions {
        sentences.push("The studies have different ground motions, whose choice also moves the ranks.".into());
    }
    if !refused.is_empty() {
        sentences.push(format!("{} could not be assessed; see below.", counted(refused.len() as u64, "study file")));
    }
    sentences
}

/// The objects as CSV, in SI units and full precision.
fn table(portfolio: &Portfolio) -> std::io::Result<String> {
    type Row = RankedObject;
    let rank = |column: &str, value: fn(&Row) -> Option<usize>| {
        TableColumn::optional(column, "1", move |object: &Row| value(object).map(|rank| rank as f64))
    };
    let rate = |column: &str, value: fn(RateResult) -> Option<f64>| {
        TableColumn::optional(column, "1/year", move |object: &Row| object.state.rate.and_then(value))
    };
    let share = |column: &str, value: fn(RateResult) -> f64| {
        TableColumn::optional(column, "1", move |object: &Row| object.state.rate.map(value))
    };
    let count = |column: &str, value: fn(&Counts) -> usize| {
        TableColumn::count(column, move |object: &Row| value(&object.state.runs))
    };
    let columns = [
        rank("rank", |object| object.rank),
        rank("rank.least", |object| Some(object.ranks?[0])),
        rank("rank.greatest", |object| Some(object.ranks?[1])),
        TableColumn::text("object", |object: &Row| object.title.clone()),
        TableColumn::text("study", |object: &Row| object.study.clone()),
        TableColumn::text("page", |object: &Row| format!("{}/{}", object.name, crate::PAGE)),
        TableColumn::text("floors", |object: &Row| {
            object.floors.iter().map(ToString::to_string).collect::<Vec<_>>().join(" ")
        }),
        TableColumn::optional("building.period", "s", |object: &Row| object.building_period),
        TableColumn::text("state", |object: &Row| object.state.name.clone()),
        TableColumn::text("limit", |object: &Row| object.state.limit.to_string()),
        TableColumn::text("source", |object: &Row| object.state.source.clone().unwrap_or_default()),
        count("runs", |runs| runs.known),
        count("exceeded", |runs| runs.exceeded),
        count("unknown", |runs| runs.left_out),
        rate("rate", |found| Some(found.rate)),
        rate("rate.low", |found| found.rate_interval[0]),
        rate("rate.high", |found| found.rate_interval[1]),
        rate("rate.if_no_unknown_exceeds", |found| found.rate_of_unknown.and_then(|[none, _]| none)),
        rate("rate.if_all_unknown_exceed", |found| found.rate_of_unknown.and_then(|[_, all]| all)),
        share("probability", |found| found.probability),
        share("rate.above_runs", |found| found.above_runs),
        share("rate.below_runs", |found| found.below_runs),
        share("rate.outside_hazard", |found| found.outside_hazard),
        TableColumn::text("no_curve", |object: &Row| object.state.no_curve.clone().unwrap_or_default()),
        TableColumn::text("first.state", |object: &Row| {
            object.first.as_ref().map(|first| first.name.clone()).unwrap_or_default()
        }),
        TableColumn::optional("first.rate", "1/year", |object: &Row| object.first.as_ref().map(|first| first.rate)),
        TableColumn::text("helps", helps),
        TableColumn::text("matters", |object: &Row| {
            object.matters.as_ref().map(|matter| matter.name.clone()).unwrap_or_default()
        }),
    ];
    let head = format!(
        "# rocking-block {} portfolio, probabilities in {} years\n",
        env!("CARGO_PKG_VERSION"),
        portfolio.years
    );
    Ok(head + &with_headings(&Table::of(&columns, &portfolio.objects))?)
}

/// Writes the objects as lines of a terminal, below the sentences of the page.
pub fn portfolio_text(portfolio: &Portfolio) -> String {
    let heads = ["rank", "object", "state", "rate, 1/year", "interval", "helps"].map(String::from);
    let rows = portfolio.objects.iter().map(|object| {
        let found = object.rate().map_or_else(|| "—".into(), rate);
        [rank(object), object.title.clone(), object.state.name.clone(), found, interval(object), helps(object)]
    });
    let rows: Vec<[String; 6]> = std::iter::once(heads).chain(rows).collect();
    let width = |column: usize| rows.iter().map(|row| row[column].chars().count()).max().unwrap_or_default();
    let widths: Vec<usize> = (0..5).map(width).collect();
    let line = |row: &[String; 6]| {
        let cells = row.iter().zip(&widths).map(|(cell, width)| format!("{cell:<width$}  "));
        cells.collect::<String>() + &row[5] + "\n"
    };
    let refused = portfolio.refused.iter().map(|refused| format!("not assessed  {}\n", refused.reason));
    let sentences = sentences(portfolio).into_iter().map(|sentence| sentence + "\n");
    sentences.chain(rows.iter().map(line)).chain(refused).collect()
}
