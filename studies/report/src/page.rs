//! Results, pictures and sentences → HTML.

use askama::Template;

use crate::commands::commands;
use crate::numbers::{self, heading, interval, limit, long, rate, short};
use crate::pictures::Picture;
use crate::sentences::{summary, verdict};
use crate::{ReportError, range};
use rocking_block::excitation::PulseShape;
use rocking_studies::assess::{
    BodyResult, Comparison, Counts, CurveResult, LeastPulse, Plan, RateResult, Report, Results,
};
use rocking_studies::fragility::Direction;
use rocking_studies::intensity::OverDirections;
use rocking_studies::spec::words::Words;

/// Fills the template.
pub fn page(plan: &Plan, results: &Results, pictures: &[Picture]) -> Result<String, ReportError> {
    let report = &results.report;
    let (measure, unit) = heading(&report.im);
    let page = Page {
        report,
        plan,
        pictures,
        measure,
        unit: unit.trim().to_string(),
        compared: limit(report.states[report.compared_state].limit),
        beyond: numbers::exceed(report.states[report.compared_state].limit).replace(" = ", "\u{a0}=\u{a0}"),
        verdict: verdict(report, range(results)),
        by: by(report),
        words: words(report),
        summary: summary(report, range(results)),
        over: match is_in_space(report) {
            true => format!(".{}", plan.measure.of_component().1.unwrap_or(OverDirections::RotD50).word()),
            false => String::new(),
        },
        range: range(results),
        commands: commands(plan, results),
        version: env!("CARGO_PKG_VERSION"),
        study: &plan.sweep.text,
    };
    Ok(page.render()?)
}

/// Names author and date, or says that the study does not.
fn by(report: &Report) -> String {
    match (&report.author, &report.date) {
        (Some(author), Some(date)) => format!("{author}, {date}."),
        (Some(author), None) => format!("{author}; the study has no date."),
        (None, Some(date)) => format!("{date}; the study names no author."),
        (None, None) => "The study names neither author nor date.".into(),
    }
}

/// Returns the meaning of the words that the page has.
fn words(report: &Report) -> Vec<(&'static str, &'static str)> {
    let has = |word: &str| match word {
        "PFA" | "PFV" => report.building.is_some(),
        "θ" | "α" => !is_in_space(report),
        "tilt" | "tilt/α" | "α_edge" | "twist" | "drift" | "azimuth" => is_in_space(report),
        "RotD50" | "RotD100" | "larger" | "geomean" => report.im.contains(word),
        "μ" => !report.sliding.is_empty() || report.object.friction.is_finite(),
        _ => true,
    };
    numbers::WORDS.into_iter().filter(|(word, _)| has(word)).collect()
}

fn is_in_space(report: &Report) -> bool {
    matches!(report.object.body, BodyResult::Space(_))
}

#[derive(Template)]
#[template(path = "report.html")]
struct Page<'a> {
    report: &'a Report,
    plan: &'a Plan,
    pictures: &'a [Picture],
    /// Name and unit of the intensity measure.
    measure: String,
    unit: String,
    /// Limit of variants, friction and sensitivity.
    compared: String,
    /// The predicate of runs beyond it.
    beyond: String,
    /// Least and greatest measure of the runs.
    range: [f64; 2],
    /// The two lines above all others.
    verdict: [String; 2],
    /// Author and date.
    by: String,
    /// Symbols and their meaning.
    words: Vec<(&'static str, &'static str)>,
    summary: Vec<String>,
    /// How the measures of both components in space become one, after the name of a measure.
    over: String,
    commands: Vec<String>,
    version: &'static str,
    /// The study, line by line.
    study: &'a [String],
}

/// The functions of the template beside those of [`numbers`].
impl Page<'_> {
    /// Returns the drawing with this name, if any.
    fn picture(&self, name: &str) -> Option<&str> {
        self.pictures.iter().find(|picture| picture.name == name).map(|picture| picture.svg.as_str())
    }

    /// Writes a range, or its only value.
    fn range(&self, [low, high]: &[f64; 2]) -> String {
        if low == high { long(*low) } else { format!("{} to {}", long(*low), long(*high)) }
    }

    fn span(&self, [low, high]: &[f64; 2]) -> String {
        format!("{} to {}", short(*low), short(*high))
    }

    fn optional(&self, value: &Option<f64>) -> String {
        value.map_or("—".into(), short)
    }

    /// Writes an acceleration relative to gravity.
    fn in_g(&self, value: &Option<f64>) -> String {
        self.optional(&value.map(|value| value / self.report.object.g))
    }

    fn counts(&self, counts: &Counts) -> String {
        format!("{} of {}", numbers::exceeded(counts), counts.all())
    }

    fn median(&self, curve: &Option<CurveResult>) -> String {
        curve.map_or("—".into(), |curve| numbers::median(curve.median, self.range))
    }

    fn median_interval(&self, curve: &Option<CurveResult>) -> String {
        curve.map_or("—".into(), |curve| interval(curve.median_interval))
    }

    fn beta(&self, curve: &Option<CurveResult>) -> String {
        curve.map_or("—".into(), |curve| short(curve.beta))
    }

    /// Writes an annual rate, with its range where runs have no known outcome.
    fn state_rate(&self, found: &RateResult) -> String {
        let range = found.rate_of_unknown.and_then(numbers::rate_range);
        let range = range.map(|range| format!("; {range} with the runs of unknown outcome"));
        rate(found.rate) + &range.unwrap_or_default()
    }

    fn variant_rate(&self, variant: &Comparison) -> String {
        match variant.rate_of_unknown {
            Some(range) => numbers::rate_range(range),
            None => variant.rate.map(rate),
        }
        .unwrap_or_else(|| "—".into())
    }

    /// Writes where the runs of a state without an annual rate lie.
    fn without_rate(&self, separate_at: &[Option<f64>; 2]) -> String {
        let (measure, unit) = heading(&self.report.im);
        let runs = numbers::separate(*separate_at, &numbers::motions(self.report), (&measure, &unit));
        runs.unwrap_or_else(|| "—".into())
    }

    fn is_in_space(&self) -> bool {
        is_in_space(self.report)
    }

    /// Writes the moments of inertia about x, y and z.
    fn moments(&self, [xx, yy, zz, ..]: &[f64; 6]) -> String {
        [xx, yy, zz].map(|moment| long(*moment)).join(", ")
    }

    /// Writes the direction of a pulse.
    fn azimuth(&self, azimuth: &Option<f64>) -> String {
        azimuth.map_or("—".into(), |azimuth| format!("{}°", long(azimuth)))
    }

    /// Writes the azimuth of a direction, or its sector.
    fn sector(&self, direction: &Direction) -> String {
        let Direction { azimuth, width, .. } = *direction;
        match width {
            0.0 => format!("{}°", short(azimuth)),
            width => format!("{}° to {}°", azimuth - 0.5 * width, azimuth + 0.5 * width),
        }
    }

    /// Writes a median tilt, where it is known.
    fn tilt(&self, median: &Option<f64>) -> String {
        match median {
            Some(tilt) if tilt.is_infinite() => "overturned".into(),
            median => self.optional(median),
        }
    }

    fn floor(&self, floor: &Option<usize>) -> String {
        floor.map_or("—".into(), |floor| floor.to_string())
    }

    /// Writes the amplitude of a least pulse relative to gravity.
    fn pulse(&self, pulse: &LeastPulse) -> String {
        let g = self.report.object.g;
        match (pulse.amplitude, pulse.bound) {
            (Some(amplitude), "none") => short(amplitude / g),
            (Some(amplitude), _) => format!("{} at most", short(amplitude / g)),
            (None, _) => format!("more than {}", short(pulse.greatest / g)),
        }
    }

    /// Writes the peak ground velocity of the least pulse (m/s) for shapes with a closed form.
    fn pulse_velocity(&self, pulse: &LeastPulse) -> String {
        let per_amplitude = match self.plan.pulse {
            // v_g = v_p/2 (1 − cos ω_p t), a_p = ω_p v_p/2: the greatest velocity is v_p.
            PulseShape::OneSine => Some(pulse.period / std::f64::consts::PI),
            // v_g = v_p sin ω_p t, a_p = ω_p v_p.
            PulseShape::OneCosine => Some(0.5 * pulse.period / std::f64::consts::PI),
            PulseShape::None
            | PulseShape::C1
            | PulseShape::C2
            | PulseShape::HalfSine
            | PulseShape::Rectangular
            | PulseShape::SymmetricRicker
            | PulseShape::AntisymmetricRicker
            | PulseShape::Gabor => None,
        };
        match (pulse.amplitude, per_amplitude) {
            (Some(amplitude), Some(factor)) if pulse.bound == "none" => short(amplitude * factor),
            _ => "—".into(),
        }
    }

    /// Writes slip and tension of a variant, and remarks on its curve.
    fn remarks(&self, variant: &Comparison) -> String {
        let slip = variant
            .peak_slip
            .map(|slip| format!("μ = {}, slips up to {} m", short(variant.friction), numbers::slip(slip)));
        let tension = variant.peak_tension.map(|tension| match variant.runs_with_broken_ties {
            None => format!("tension of a tie up to {} times the weight, with which it must not break", short(tension)),
            Some(broken) => format!(
                "a tie breaks in {broken} of {} runs; its tension reaches {} times the weight",
                variant.runs.all(),
                short(tension)
            ),
        });
        let damper =
            variant.peak_damper_force.map(|force| format!("force of a damper up to {} times the weight", short(force)));
        let no_curve = variant.no_curve.as_ref().map(|why| numbers::no_curve(&variant.runs, why));
        let left_out = match variant.runs.left_out {
            0 => None,
            1 => Some("1 run without a known outcome".into()),
            runs => Some(format!("{runs} runs without a known outcome")),
        };
        let limit =
            (variant.limit != self.report.variants[0].limit).then(|| format!("limit: {}", limit(variant.limit)));
        [limit, slip, tension, damper, no_curve, left_out].into_iter().flatten().collect::<Vec<_>>().join("; ")
    }

    /// Returns the size of the object in the spectrum, 2π/p (s).
    fn object_size(&self) -> String {
        long(std::f64::consts::TAU / self.report.object.p)
    }

    /// Returns the fraction of ground motions that overturn the object at the strength of the spectrum.
    fn object_outcome(&self) -> Option<String> {
        let sizes = &self.report.sizes;
        let p = self.report.object.p;
        let size = sizes.iter().min_by(|a, b| (a.p - p).abs().total_cmp(&(b.p - p).abs()))?;
        let all = size.rocked + size.at_rest + size.overturned + size.undecided;
        let overturn = if size.overturned == 1 { "overturns" } else { "overturn" };
        Some(format!("{} of {all} ground motions {overturn} the object itself", size.overturned))
    }

    fn rate_interval(&self, interval: &[Option<f64>; 2]) -> String {
        numbers::rate_range(*interval).unwrap_or_else(|| "unbounded".into())
    }

    /// Whether a variant has limited friction that the object has not.
    fn has_sliding_variant(&self) -> bool {
        self.report.variants.iter().skip(1).any(|variant| variant.friction.is_finite())
    }

    /// Whether the interval of the compared curve's median has no end.
    fn is_unbounded(&self) -> bool {
        let curve = self.report.states[self.report.compared_state].curve;
        curve.is_some_and(|curve| curve.median_interval == [None; 2])
    }

    fn has_usual_ranges(&self) -> bool {
        self.report.sensitivity.iter().any(|sensitivity| !sensitivity.assumption.is_given)
    }
}
