//! Results → plain English.

use crate::numbers::{
    self, counted, exceed, exceeds_in_words, ground_motions, heading, interval, limit, long, named_quantity, no_curve,
    percent, rate, short, spelled, years,
};
use rocking_studies::assess::{BodyResult, BuildingResult, Comparison, ObjectResult, Report, SpaceResult, StateResult};
use rocking_studies::fragility::Limit;

/// Writes the verdict in two lines without symbols: what the object withstands, then how often it does not and what helps.
pub fn verdict(report: &Report, [least, greatest]: [f64; 2]) -> [String; 2] {
    let state = &report.states[report.compared_state];
    let (measure, unit) = heading(&report.im);
    let happens = match state.limit {
        Limit::Overturned | Limit::Balance => exceeds_in_words(state.limit),
        // The name says more to its author than the words for the limit.
        Limit::Rotation(_)
        | Limit::Slip(_)
        | Limit::Plastic(_)
        | Limit::HalfCycles(_)
        | Limit::Breaks
        | Limit::Tilt(_)
        | Limit::Twist(_)
        | Limit::Drift(_) => {
            format!("{} (“{}”)", exceeds_in_words(state.limit), state.name)
        }
    };
    let worst = report.states.last().filter(|worst| worst.limit == Limit::Overturned && worst.runs.at_most() == 0);
    let stands = worst.map_or("", |_| "; it overturns in none of these runs");
    let half = match state.curve.map(|curve| curve.median) {
        Some(median) if median > greatest => "; the fragility curve reaches one half only above these levels".into(),
        Some(median) if median < least => "; the fragility curve reaches one half below these levels already".into(),
        Some(median) => format!("; the fragility curve reaches one half at {}{unit}", short(median)),
        None => String::new(),
    };
    let capacity = format!(
        "The object {happens} in {} of {} computed runs under {} with a {} from {} to {}{unit}{half}{stands}.",
        numbers::exceeded(&state.runs),
        state.runs.all(),
        ground_motions(report),
        spelled(&measure),
        short(least),
        short(greatest)
    );
    let often = match (state.rate, &report.hazard) {
        (Some(found), _) => {
            let range = numbers::rate_range(found.rate_interval);
            let range =
                range.map(|range| format!(" (rate per year with {} confidence: {range})", percent(report.confidence)));
            format!(
                "At the site this is expected once in {} years on average, with a probability of {} in {} years{}.",
                years(1.0 / found.rate),
                percent(found.probability),
                report.years,
                range.unwrap_or_else(|| {
                    format!(
                        "; {} too few to bound the error",
                        if report.independent_motions() == 1 {
                            "one ground motion is"
                        } else {
                            "the ground motions are"
                        }
                    )
                })
            )
        }
        (None, Some(_)) => "How often this happens at the site cannot be computed from these runs.".into(),
        (None, None) => "How often this happens is not known: the study names no seismic hazard of a site.".into(),
    };
    [capacity, often]
}

/// Writes the result in a few sentences.
pub fn summary(report: &Report, range: [f64; 2]) -> Vec<String> {
    let state = &report.states[report.compared_state];
    let (measure, unit) = heading(&report.im);
    let mut sentences = vec![object(&report.object, report.building.as_ref())];
    sentences.extend(report.building.as_ref().map(building));
    let count = |state: &StateResult| match state.runs.at_most() {
        0 => format!("none {}", exceed(state.limit)),
        _ => format!("{} {}", numbers::exceeded(&state.runs), exceed(state.limit)),
    };
    let counts: Vec<String> = report.states.iter().map(count).collect();
    sentences.push(format!(
        "In {} ({} × {} × {}) {}.",
        counted(report.runs, "run"),
        counted(report.blocks, "block"),
        ground_motions(report),
        counted(report.strengths.len() as u64, "strength"),
        join(&counts)
    ));
    match state.curve {
        Some(curve) if !(range[0]..=range[1]).contains(&curve.median) => sentences.push(format!(
            "The {measure} at which the probability of {} is one half lies outside the range of the runs, from {} to {}{unit}.",
            limit(state.limit),
            short(range[0]),
            short(range[1])
        )),
        Some(curve) => {
            let ends = match curve.median_interval {
                [None, None] => format!(
                    "; the {} interval is unbounded: {} carry too little information",
                    percent(report.confidence),
                    ground_motions(report)
                ),
                ends => format!(" ({} interval: {}{unit})", percent(report.confidence), interval(ends)),
            };
            sentences.push(format!(
                "At a {measure} of {}{unit}, the probability of {} is one half{ends}.",
                short(curve.median),
                limit(state.limit)
            ));
        }
        None => {
            let reason = no_curve(&state.runs, state.no_curve.as_deref().unwrap_or_default());
            sentences.push(format!("There is no fragility curve: {reason}."));
        }
    }
    if let (Some(found), Some(hazard)) = (state.rate, &report.hazard) {
        sentences.push(format!(
            "With the hazard curve {}, the annual rate of {} is {} ({} interval: {}): once in {} years. The probability in {} years is {}.",
            hazard.file,
            limit(state.limit),
            rate(found.rate),
            percent(report.confidence),
            numbers::rate_range(found.rate_interval).unwrap_or_else(|| "unbounded".into()),
            years(1.0 / found.rate),
            report.years,
            percent(found.probability)
        ));
    } else if let (Some(_), Some(runs)) =
        (&report.hazard, numbers::separate(state.separate_at, &numbers::motions(report), (&measure, &unit)))
    {
        sentences.push(format!("There is no annual rate of {}: {runs}.", limit(state.limit)));
    }
    sentences.extend(ties(report));
    sentences.extend(best_variants(report));
    sentences.extend(strongest_assumption(report));
    sentences
}

fn object(object: &ObjectResult, building: Option<&BuildingResult>) -> String {
    if let BodyResult::Space(body) = &object.body {
        return in_space(object, body);
    }
    let ObjectResult { width, center_height, alpha, p, foundation, static_threshold, g, friction, .. } = object;
    let is_rigid = *foundation == "rigid";
    let base = if is_rigid { "It stands on a rigid base" } else { "It stands on viscoelastic supports" };
    let subject = if is_rigid { "it" } else { "on a rigid base it" };
    let start = match static_threshold {
        Some(threshold) if friction * g < *threshold => {
            format!("; {subject} would slide beyond {} g, before it rocks", long(*friction))
        }
        Some(threshold) => {
            let place = if building.is_some() { "floor" } else { "ground" };
            let pga = building.and_then(|building| building.least_pga).map(|pga| {
                format!(
                    ". The building amplifies the ground motions: one with a PGA of {} g can be enough",
                    long(pga / g)
                )
            });
            let threshold = long(threshold / g);
            format!(
                "; {subject} would begin to rock at a horizontal {place} acceleration of {threshold} g{}",
                pga.unwrap_or_default()
            )
        }
        None => String::new(),
    };
    format!(
        "A base {} m wide and a centre of mass {} m up give a slenderness α of {} rad ({}°) and a frequency parameter p of {} rad/s. \
         {base}{start}.",
        long(*width),
        long(*center_height),
        long(*alpha),
        short(alpha.to_degrees()),
        long(*p)
    )
}

fn in_space(object: &ObjectResult, body: &SpaceResult) -> String {
    let ObjectResult { width, center_height, alpha, p, static_threshold, g, friction, .. } = object;
    let base = match body.base {
        "rectangle" => format!("A base of {} m × {} m", long(*width), long(body.depth)),
        "circle" => format!("A circular base with a diameter of {} m", long(*width)),
        _ => format!("A base of {} feet whose nearest edge is {} m away", body.feet, long(0.5 * width)),
    };
    let start = match static_threshold {
        Some(threshold) if friction * g < *threshold => {
            format!("would slide beyond {} g, before it rocks", long(*friction))
        }
        threshold => {
            let threshold = long(threshold.unwrap_or_default() / g);
            format!("would begin to rock over its nearest edge at a horizontal acceleration of {threshold} g")
        }
    };
    format!(
        "{base} and a centre of mass {} m up give a balance over the nearest edge at {}° and a frequency parameter p of {} rad/s. It stands \
         on {} viscoelastic feet and can rock, roll over corners, twist and slide; on rigid feet it {start}.",
        long(*center_height),
        short(alpha.to_degrees()),
        long(*p),
        body.feet
    )
}

fn building(building: &BuildingResult) -> String {
    let BuildingResult { floors, stands_on, periods, damping, .. } = building;
    let floor = |&floor: &usize| if floor == 0 { "the ground".into() } else { format!("floor {floor}") };
    let floors = if *floors == 1 { "one floor".into() } else { format!("{floors} floors") };
    let places: Vec<String> = stands_on.iter().map(floor).collect();
    format!(
        "It stands on {} of an elastic building of {floors} with a first period of {} s (damping {}), whose ground has the ground motions \
         and pulses.",
        join(&places),
        short(periods[0]),
        percent(damping[0])
    )
}

/// States the runs of the object in which a tie broke.
fn ties(report: &Report) -> Option<String> {
    let plain = report.variants.first()?;
    let broken = plain.runs_with_broken_ties?;
    let ties = match &report.object.body {
        BodyResult::Plane(body) if body.ties != 1 => format!("one of its {} ties", body.ties),
        BodyResult::Plane(_) | BodyResult::Space(_) => "its tie".into(),
    };
    Some(format!("In {broken} of {} runs {ties} breaks.", plain.runs.all()))
}

/// Names the variant with the least annual rate, if the object has one. Where runs have no known outcome, the greatest rate counts.
fn best_rate(report: &Report) -> Option<String> {
    let best = report.least_rate()?;
    if !report.reduces_rate(best) {
        return Some("No variant with an annual rate is known to reduce it.".into());
    }
    let (before, after) = (report.variants[0].rates()?, best.rates()?);
    let shown = |[low, high]: [f64; 2]| match low == high {
        true => rate(low),
        false => numbers::rate_range([Some(low), Some(high)]).unwrap_or_default(),
    };
    let text = format!(
        "Of the variants with an annual rate, “{}” helps most: {} instead of {}, for {}.",
        best.name,
        shown(after),
        shown(before),
        limit(best.limit)
    );
    Some(text + &slips(report, best).unwrap_or_default())
}

/// Names the variants without any exceedance.
fn without_exceedance(report: &Report) -> Option<String> {
    let best = report.without_exceedance();
    if best.is_empty() {
        return None;
    }
    let (measure, unit) = heading(&report.im);
    let runs = numbers::separate(best[0].separate_at, &numbers::motions(report), (&measure, &unit))?;
    let names: Vec<String> = best.iter().map(|variant| format!("“{}”", variant.name)).collect();
    let helps = if best.len() == 1 { "helps" } else { "help" };
    let mut text = format!("Of the variants, {} {} most: {runs}.", join(&names), helps);
    text.extend(best.iter().filter_map(|variant| slips(report, variant)));
    Some(text)
}

/// Names the best variants: those without an exceedance, then by their rates, or else by their runs.
fn best_variants(report: &Report) -> Option<String> {
    let sentences = [without_exceedance(report), best_rate(report)].into_iter().flatten().collect::<Vec<_>>();
    if sentences.is_empty() { fewest_runs(report) } else { Some(sentences.join(" ")) }
}

/// Names the variants with the fewest runs beyond the limit, and their slip. These runs are fewer than those of the object.
fn fewest_runs(report: &Report) -> Option<String> {
    let plain = report.variants.first()?;
    let exceed = exceed(report.states[report.compared_state].limit);
    let best = report.fewest_runs();
    if best.is_empty() {
        return Some(format!("No variant reduces the number of runs that {exceed}."));
    }
    let names: Vec<String> = best.iter().map(|variant| format!("“{}”", variant.name)).collect();
    // Blocks with ties have a limit of their own.
    let mut verbs: Vec<String> = best.iter().map(|variant| numbers::exceed(variant.limit)).collect();
    verbs.dedup();
    let before = numbers::exceeded(&plain.runs);
    let before = match verbs.iter().all(|verb| *verb == exceed) {
        true => format!(" instead of {before}"),
        false => format!("; as it is, {before} {exceed}"),
    };
    let mut text = format!(
        "Of the variants, {} {} most: {} of {} runs {}{before}.",
        join(&names),
        if best.len() == 1 { "helps" } else { "help" },
        numbers::exceeded(&best[0].runs),
        best[0].runs.all(),
        verbs.join(" or ")
    );
    text.extend(best.iter().filter_map(|variant| slips(report, variant)));
    Some(text)
}

/// States the greatest slip of a variant, and the states that it reaches.
fn slips(report: &Report, variant: &Comparison) -> Option<String> {
    let slip = variant.peak_slip.filter(|slip| *slip > 0.0)?;
    let is_beyond = |state: &&StateResult| matches!(state.limit, Limit::Slip(limit) if slip > limit);
    let beyond: Vec<String> = report.states.iter().filter(is_beyond).map(|state| format!("“{}”", state.name)).collect();
    let reaches = if beyond.is_empty() { String::new() } else { format!(", which reaches {}", join(&beyond)) };
    Some(format!(" But “{}” slips by up to {} m{reaches}.", variant.name, numbers::slip(slip)))
}

/// The assumption whose range changes the count of runs most.
fn strongest_assumption(report: &Report) -> Option<String> {
    let strongest = report.strongest_assumption()?;
    let exceed = exceed(report.states[report.compared_state].limit);
    let [low, high] = &strongest.ends;
    if strongest.change() == 0 {
        return Some(format!("No assumption changes the number of runs that {exceed}."));
    }
    let (name, unit) = named_quantity(&strongest.assumption.name);
    Some(format!(
        "Of the assumptions, the {name} matters most: {} runs {exceed} with {}{unit}, {} with {}{unit}.",
        numbers::exceeded(&low.runs),
        short(strongest.assumption.values[0]),
        numbers::exceeded(&high.runs),
        short(strongest.assumption.values[1])
    ))
}

/// Joins items as in “a, b and c”.
fn join(items: &[String]) -> String {
    match items {
        [] => String::new(),
        [one] => one.clone(),
        [first @ .., last] => format!("{} and {last}", first.join(", ")),
    }
}

#[cfg(test)]
mod tests {
    use std::collections::BTreeSet;

    const TABLE: &str = include_str!("../../../docs/studies/report.md");
    const RESULTS: &str = include_str!("../../engine/src/assess/results.rs");
    /// Shorter texts are parts of sentences.
    const FEWEST_WORDS: usize = 4;

    /// Returns the sentences among the texts in quotes of a source, without its tests.
    fn sentences(source: &str) -> BTreeSet<String> {
        let code = source.split("#[cfg(test)]").next().unwrap();
        let lines = code.lines().map(str::trim_start).filter(|line| !line.starts_with("//"));
        let code = lines.collect::<Vec<_>>().join("\n").replace("\\\n", "");
        let texts = code.split('"').skip(1).step_by(2).map(|text| text.trim().to_owned());
        texts.filter(|text| text.split_whitespace().count() >= FEWEST_WORDS).collect()
    }

    /// Every sentence has a row with its numbers, every row is a sentence, and every key is one of the results.
    #[test]
    fn each_sentence_has_its_numbers_in_the_table() {
        let code = [include_str!("sentences.rs"), include_str!("../../engine/src/assess/work.rs")];
        let found: BTreeSet<String> = code.into_iter().flat_map(sentences).collect();
        let rows = || TABLE.lines().filter_map(|line| line.strip_prefix("| `")?.strip_suffix(" |")?.split_once("` | "));
        let listed: BTreeSet<String> = rows().map(|(sentence, _)| sentence.to_owned()).collect();
        assert_eq!(found.difference(&listed).collect::<Vec<_>>(), Vec::<&String>::new(), "not in the table");
        assert_eq!(listed.difference(&found).collect::<Vec<_>>(), Vec::<&String>::new(), "not in the code");
        for (sentence, numbers) in rows() {
            for key in numbers.split('`').skip(1).step_by(2).filter(|key| !key.contains(' ')) {
                let field = key.rsplit('.').next().unwrap();
                assert!(RESULTS.contains(&format!("pub {field}: ")) || field == "values", "{key} of {sentence}");
            }
        }
    }
}
