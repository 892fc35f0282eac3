//! The results of all objects → their order.

use serde::Serialize;

use crate::assess::{Comparison, Counts, HazardResult, Report, StateResult};
use crate::fragility::Limit;
use crate::portfolio::studies::{ObjectStudy, RefusedStudy};

/// Objects in the order of their annual rates.
#[derive(Clone, Debug, Serialize)]
pub struct Portfolio {
    /// The hazard curve, if any study has one.
    pub hazard: Option<HazardResult>,
    /// Years of the probabilities.
    pub years: f64,
    /// Confidence level of all intervals.
    pub confidence: f64,
    /// The objects: those with a rank, the greatest rate first, then the others.
    pub objects: Vec<RankedObject>,
    /// Sum of the rates (1/year): the number of objects per year that exceed their limits, with at least one rate.
    pub together: Option<f64>,
    /// Whether all objects have the same ground motions.
    pub has_same_motions: bool,
    /// Studies that were not assessed.
    pub refused: Vec<RefusedStudy>,
}

/// An object of a portfolio.
#[derive(Clone, Debug, Serialize)]
pub struct RankedObject {
    /// From 1, the greatest rate; `None` without a rate.
    pub rank: Option<usize>,
    /// Least and greatest rank that the intervals of the rates allow.
    pub ranks: Option<[usize; 2]>,
    /// Name of its results.
    pub name: String,
    /// The object.
    pub title: String,
    /// The study file.
    pub study: String,
    /// Floors of a building on which it stands; 0 is the ground. Empty without a building.
    pub floors: Vec<usize>,
    /// First period of the building (s).
    pub building_period: Option<f64>,
    /// The last, most severe state of its study. Its rate is the one that ranks.
    pub state: StateResult,
    /// The state with the greatest annual rate, if it is another one.
    pub first: Option<FirstState>,
    /// The variants that help, for the limit of each.
    pub helps: Vec<Help>,
    /// The assumption that changes the number of runs beyond the limit most, if one does.
    pub matters: Option<Matter>,
    /// Number of independent ground motions.
    pub motions: usize,
    /// The report on the object alone.
    #[serde(skip)]
    pub report: Report,
}

/// The state that an object exceeds first.
#[derive(Clone, Debug, Serialize)]
pub struct FirstState {
    /// Its name.
    pub name: String,
    /// The limit.
    pub limit: Limit,
    /// Its annual rate (1/year).
    pub rate: f64,
}

/// A variant that helps.
#[derive(Clone, Debug, Serialize)]
pub struct Help {
    /// Its name.
    pub variant: String,
    /// The limit to which its numbers refer.
    pub limit: Limit,
    /// The runs, relative to the limit.
    pub runs: Counts,
    /// The least and the greatest annual rate (1/year) over all outcomes of runs that have none.
    pub rates: Option<[f64; 2]>,
    /// Greatest slip (m), with limited friction.
    pub peak_slip: Option<f64>,
}

impl From<&Comparison> for Help {
    fn from(variant: &Comparison) -> Help {
        Help {
            variant: variant.name.clone(),
            limit: variant.limit,
            runs: variant.runs,
            rates: variant.rates(),
            peak_slip: variant.peak_slip,
        }
    }
}

/// An assumption and the runs beyond the limit at both ends of its range.
#[derive(Clone, Debug, Serialize)]
pub struct Matter {
    /// Name and unit.
    pub name: String,
    /// Both ends of its range.
    pub values: [f64; 2],
    /// The limit.
    pub limit: Limit,
    /// The runs there.
    pub runs: [Counts; 2],
}

impl RankedObject {
    fn new(study: &ObjectStudy, report: Report) -> RankedObject {
        let state = report.states[report.states.len() - 1].clone();
        let rate = |state: &StateResult| state.rate.map(|rate| rate.rate);
        let first = report.states.iter().filter_map(|state| Some((state, rate(state)?)));
        let first = first.max_by(|(_, one), (_, other)| one.total_cmp(other));
        let first = first.filter(|(first, _)| first.name != state.name);
        let matters = report.strongest_assumption().filter(|strongest| strongest.change() > 0);
        RankedObject {
            rank: None,
            ranks: None,
            name: study.name.clone(),
            title: report.title.clone(),
            study: study.file.display().to_string(),
            floors: report.building.as_ref().map(|building| building.stands_on.clone()).unwrap_or_default(),
            building_period: report.building.as_ref().and_then(|building| building.periods.first().copied()),
            first: first.map(|(first, rate)| FirstState { name: first.name.clone(), limit: first.limit, rate }),
            helps: report.helpful().into_iter().map(Help::from).collect(),
            matters: matters.map(|strongest| Matter {
                name: strongest.assumption.name.clone(),
                values: strongest.assumption.values,
                limit: strongest.ends[0].limit,
                runs: strongest.ends.each_ref().map(|end| end.runs),
            }),
            motions: report.independent_motions(),
            state,
            report,
        }
    }

    /// The annual rate (1/year) that ranks.
    pub fn rate(&self) -> Option<f64> {
        self.state.rate.map(|rate| rate.rate)
    }

    /// Least and greatest annual rate (1/year) by its interval and the runs without a known outcome. Without a bound they are 0 and infinite.
    fn bounds(&self) -> Option<[f64; 2]> {
        let found = self.state.rate?;
        let [low, high] = [found.rate_interval[0].unwrap_or(0.0), found.rate_interval[1].unwrap_or(f64::INFINITY)];
        let Some([none, all]) = found.rate_of_unknown else { return Some([low, high]) };
        Some([low.min(none.unwrap_or(0.0)), high.max(all.unwrap_or(f64::INFINITY))])
    }
}

impl Portfolio {
    /// Ranks objects by the annual rate of their most severe states.
    pub(super) fn new(reports: Vec<(&ObjectStudy, Report)>, refused: Vec<RefusedStudy>) -> Portfolio {
        let (years, confidence) = reports.first().map_or((f64::NAN, f64::NAN), |(_, of)| (of.years, of.confidence));
        let hazard = reports.iter().find_map(|(_, report)| report.hazard.clone());
        let has_same_motions = reports.windows(2).all(|pair| records(pair[0].0) == records(pair[1].0));
        let mut objects: Vec<RankedObject> =
            reports.into_iter().map(|(study, report)| RankedObject::new(study, report)).collect();
        // Without rates, those that exceed their limits in more runs come first. Equal ones stay in the order of their files.
        let place = |object: &RankedObject| {
            let runs = object.state.runs;
            [object.rate().unwrap_or(f64::NEG_INFINITY), runs.exceeded as f64 / runs.all().max(1) as f64]
        };
        objects.sort_by(|one, other| {
            let ([rate, exceeded], [of_other, by_other]) = (place(one), place(other));
            of_other.total_cmp(&rate).then(by_other.total_cmp(&exceeded))
        });
        let bounds: Vec<Option<[f64; 2]>> = objects.iter().map(RankedObject::bounds).collect();
        let ranked = bounds.iter().flatten().count();
        for (number, object) in objects.iter_mut().enumerate() {
            let Some([low, high]) = bounds[number] else { continue };
            let above = bounds.iter().flatten().filter(|other| other[0] > high).count();
            let below = bounds.iter().flatten().filter(|other| other[1] < low).count();
            (object.rank, object.ranks) = (Some(number + 1), Some([above + 1, ranked - below]));
        }
        let together = objects.iter().filter_map(RankedObject::rate).reduce(|sum, rate| sum + rate);
        Portfolio { hazard, years, confidence, objects, together, has_same_motions, refused }
    }
}

/// The checksums of the records of a study.
fn records(study: &ObjectStudy) -> Vec<&str> {
    let plan = &study.plan;
    let is_record = |file: &str| plan.sweep.motions.iter().any(|motion| motion.files.iter().any(|of| of == file));
    let mut sums: Vec<&str> =
        plan.inputs.iter().filter(|input| is_record(&input.file)).map(|input| input.sha256.as_str()).collect();
    sums.sort_unstable();
    sums
}
