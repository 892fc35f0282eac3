//! A plan → its results.

use std::convert::Infallible;
use std::sync::atomic::{AtomicU64, Ordering};

use rayon::ThreadPool;

use crate::assess::alternatives::{Alternative, Assumption};
use crate::assess::plan::Plan;
use crate::assess::results::{
    Comparison, Counts, HazardResult, MotionResult, ObjectResult, Report, Sensitivity, SlidingResult, SupportsResult,
};
use crate::assess::spectrum::SizeSpectrum;
use crate::assess::states::{CONFIDENCE, StateCurve};
use crate::assess::{pulses, spectrum};
use crate::fragility::{SweepTable, Uncertainty};
use crate::intensity::Measure;
use crate::output::fields::lines;
use crate::output::runner::{self, Study};
use crate::risk::HazardCurve;
use crate::spectrum::statistics::Statistics;
use crate::statistics::range;
use crate::sweep::Sweep;
use crate::sweep::change::Change;
use crate::sweep::strength::Strengths;
use rocking_block::block::{Block, Foundation};
use rocking_block::numerics::wide::VectorWidth;
use rocking_block::unit::variables::Variable;
use rocking_block::words::Words;

/// Coefficients of friction of the runs that slide: most pairs of `rocking foundations` lie between the first and the last.
const FRICTIONS: [f64; 3] = [0.3, 0.5, 0.7];
/// Slip (m) that counts as sliding.
const SLID: f64 = 1e-3;
/// Share of an annual rate beyond the runs or the hazard that draws a remark.
const NOTABLE: f64 = 0.01;

/// The results of an assessment: the numbers, and the data of its pictures.
pub struct Results {
    /// The numbers.
    pub report: Report,
    /// The table of the runs, with the bytes of `rocking sweep`.
    pub runs: String,
    /// The rows of that table.
    pub table: SweepTable,
    /// The curve of each state.
    pub states: Vec<StateCurve>,
    /// Blocks of the object's shape in other sizes.
    pub sizes: SizeSpectrum,
}

/// The reason why an assessment ends without results.
pub type AssessError = Box<dyn std::error::Error + Send + Sync>;

/// Work in progress.
struct Work<'a> {
    pool: &'a ThreadPool,
    width: Option<VectorWidth>,
    done: AtomicU64,
    all: AtomicU64,
    progress: &'a (dyn Fn(u64, u64) + Sync),
}

impl Work<'_> {
    fn count_run(&self) {
        let done = self.done.fetch_add(1, Ordering::Relaxed) + 1;
        (self.progress)(done, self.all.fetch_max(done, Ordering::Relaxed).max(done));
    }

    /// Makes a table.
    fn table(&self, study: &impl Study) -> Result<String, AssessError> {
        let mut rows = Vec::new();
        let make = |numbers| study.make(numbers, self.width);
        let completed = runner::in_batches(self.pool, 0..study.rows(), self.width, 1, make, |batch| {
            batch.iter().for_each(|_| self.count_run());
            rows.extend(batch);
            Ok::<(), Infallible>(())
        });
        completed.map_or_else(|never| match never {}, |()| ());
        Ok(study.header().text()? + &lines(0, rows.iter().map(|row| &row.fields))?)
    }

    /// Makes the table of a sweep and reads it.
    fn sweep(&self, name: &str, sweep: &Sweep) -> Result<(String, SweepTable), AssessError> {
        let text = self.table(sweep)?;
        let table = SweepTable::read(name, text.as_bytes())?;
        Ok((text, table))
    }
}

/// Makes all runs of a plan on a pool and evaluates them.
///
/// Runs are stepped in vectors of this width; the results depend neither on that nor on the threads. `progress` receives the number
/// of finished runs and their total, which grows as the searches proceed.
///
/// # Errors
/// A state limits the slip of blocks without friction.
pub fn assess(
    plan: &Plan,
    pool: &ThreadPool,
    width: Option<VectorWidth>,
    progress: &(dyn Fn(u64, u64) + Sync),
) -> Result<Results, AssessError> {
    let Plan { sweep, measure, states, years, .. } = plan;
    let frictions = frictions(plan);
    let (of_sizes, strength) = spectrum::of(plan)?;
    let sweeps = 1 + plan.variants.len() + frictions.len() + 2 * plan.assumptions.len();
    let all = sweeps as u64 * sweep.rows() + of_sizes.rows() + plan.pulse_periods.len() as u64 * pulses::POINTS;
    let work = Work { pool, width, done: AtomicU64::new(0), all: AtomicU64::new(all), progress };

    let (runs, table) = work.sweep("runs.csv", sweep)?;
    let hazard = plan.hazard.as_ref().map(|(_, curve)| curve);
    let curves = states.iter().map(|state| StateCurve::new(&table, *measure, state.limit, hazard));
    let curves = curves.collect::<Result<Vec<_>, _>>()?;
    let compared = curves.iter().rposition(|curve| curve.assessment.is_ok()).unwrap_or(states.len() - 1);
    let compare = |name: &str, changes: &[Change], table: &SweepTable| comparison(plan, compared, name, changes, table);
    let changed = |name: &str, changes: &[Change]| -> Result<Comparison, AssessError> {
        compare(name, changes, &work.sweep(name, &sweep.with(changes))?.1)
    };
    let mut variants = vec![compare("as it is", &[], &table)?];
    for Alternative { name, changes } in &plan.variants {
        variants.push(changed(name, changes)?);
    }
    let mut sliding = Vec::new();
    for &friction in &frictions {
        let changes = [Change::Parameter(Variable::Friction, friction)];
        let (_, table) = work.sweep("friction", &sweep.with(&changes))?;
        sliding.push(sliding_result(plan, compared, friction, &table)?);
    }
    if sweep.holds().friction {
        sliding.push(sliding_result(plan, compared, plan.block.friction, &table)?);
    }
    let mut sensitivity = Vec::new();
    for Assumption { name, changes, values, middle, is_given } in &plan.assumptions {
        let ends = [changed(name, &changes[..1])?, changed(name, &changes[1..])?];
        sensitivity.push(Sensitivity {
            name: name.clone(),
            values: *values,
            middle: *middle,
            is_given: *is_given,
            ends,
        });
    }
    let text = work.table(&of_sizes)?;
    let statistics = Statistics::of(&of_sizes, text.as_bytes())?;
    let sizes = SizeSpectrum { spectrum: of_sizes, table: text, statistics, strength };
    let pulses = pool.install(|| pulses::least(plan, width, || work.count_run()));
    let results: Vec<_> =
        states.iter().zip(&curves).map(|(state, curve)| curve.result(state, hazard, *years)).collect();
    let intervals = curves.iter().find_map(|curve| curve.assessment.as_ref().ok());
    let mut report = Report {
        title: plan.title.clone(),
        study: plan.file.clone(),
        object: object(plan),
        motions: motions(plan),
        blocks: sweep.combinations().unwrap_or(0),
        strengths: strengths(sweep),
        runs: sweep.rows(),
        im: measure.heading(),
        pulse: plan.pulse.word().into(),
        pulses,
        sizes: sizes.results(),
        sizes_strength: sizes.strength.clone(),
        states: results,
        confidence: CONFIDENCE,
        intervals: intervals.map(|found| Uncertainty::Profile.words(found.independence)),
        hazard: plan.hazard.as_ref().map(|(file, curve)| hazard_result(file, curve)),
        years: *years,
        compared_state: compared,
        variants,
        sliding,
        sensitivity,
        remarks: Vec::new(),
        inputs: plan.inputs.clone(),
    };
    report.remarks = remarks(plan, &report);
    Ok(Results { report, runs, table, states: curves, sizes })
}

/// Returns the coefficients of friction to try: none for a study with friction, or if a corner could jam.
fn frictions(plan: &Plan) -> Vec<f64> {
    let fits = |friction: &f64| {
        let change = Change::Parameter(Variable::Friction, *friction);
        !plan.sweep.holds().friction && plan.sweep.check_changes(&[change]).is_ok()
    };
    FRICTIONS.into_iter().filter(fits).collect()
}

/// Returns the quasi-static horizontal acceleration (m/s²) that lifts a corner; `None` for a block with ties.
fn static_threshold(block: &Block) -> Option<f64> {
    block.ties().is_empty().then(|| block.gravity * (block.b - block.eccentricity.abs()) / block.h)
}

fn object(plan: &Plan) -> ObjectResult {
    let Plan { sweep, block, .. } = plan;
    let blocks = || {
        (0..sweep.combinations().unwrap_or(0))
            .filter_map(|number| sweep.values(&sweep.combination(number)).block().ok())
    };
    let range = |value: fn(&Block) -> f64| range(blocks().map(|block| value(&block))).unwrap_or([value(block); 2]);
    let (supports, e) = match block.foundation {
        Foundation::Viscoelastic => {
            let supports = SupportsResult {
                stiffness: block.stiffness,
                damping: block.damping,
                eta: block.eta(),
                xi_v: block.xi_v,
                delta_s: block.static_deflection(),
            };
            (Some(supports), None)
        }
        Foundation::Rigid => (None, Some(block.restitution())),
    };
    ObjectResult {
        foundation: block.foundation.word(),
        width: 2.0 * block.b,
        center_height: block.h,
        mass: block.mass,
        alpha: block.alpha,
        alpha_range: range(|block| block.alpha),
        p: block.p,
        p_range: range(|block| block.p),
        r0: block.r0,
        gamma: block.gamma,
        g: block.gravity,
        epsilon: block.epsilon,
        supports,
        e,
        friction: block.friction,
        eccentricity: block.eccentricity,
        ties: block.ties().len(),
        static_threshold: static_threshold(block),
    }
}

fn motions(plan: &Plan) -> Vec<MotionResult> {
    let Plan { sweep, block, .. } = plan;
    let motion = |number: usize| {
        let motion = &sweep.motions[number];
        let scales = (0..sweep.strengths.count()).map(|strength| sweep.strengths.scale(strength, motion, block));
        let scales: Vec<f64> = scales.collect();
        let floor = motion.floor.map(|floor| format!(", floor {floor}")).unwrap_or_default();
        let names: Vec<&str> = motion.names.iter().map(String::as_str).filter(|name| !name.is_empty()).collect();
        MotionResult {
            name: names.join(" + ") + &floor,
            pga: motion.intensity(Measure::Pga, 1.0, block),
            pgv: motion.intensity(Measure::Pgv, 1.0, block),
            scales: range(scales.into_iter()).unwrap_or([1.0; 2]),
        }
    };
    (0..sweep.motions.len()).map(motion).collect()
}

fn strengths(sweep: &Sweep) -> Vec<String> {
    match &sweep.strengths {
        Strengths::Scales(scales) => scales.iter().map(|scale| format!("{scale} times the record")).collect(),
        Strengths::Levels(measure, levels) => {
            levels.iter().map(|level| format!("{measure} = {level} {}", measure.unit())).collect()
        }
        Strengths::Least(..) => Vec::new(),
    }
}

fn hazard_result(file: &str, curve: &HazardCurve) -> HazardResult {
    let levels = curve.levels();
    HazardResult { file: file.into(), levels: levels.len(), range: [levels[0], levels[levels.len() - 1]] }
}

/// Returns a variant relative to the compared state.
fn comparison(
    plan: &Plan,
    compared: usize,
    name: &str,
    changes: &[Change],
    table: &SweepTable,
) -> Result<Comparison, AssessError> {
    let hazard = plan.hazard.as_ref().map(|(_, curve)| curve);
    let found = StateCurve::new(table, plan.measure, plan.states[compared].limit, hazard)?;
    let sweep = plan.sweep.with(changes);
    let block = sweep.block(&plan.values)?;
    let holds = sweep.holds();
    let greatest = |columns: Vec<String>| -> Result<Option<f64>, AssessError> {
        let mut found: Option<f64> = None;
        for column in columns {
            found = table.numbers(&column)?.into_iter().flatten().chain(found).reduce(f64::max);
        }
        Ok(found)
    };
    let slip = greatest(holds.friction.then(|| "peak.slip".to_string()).into_iter().collect())?;
    let tension = greatest((1..=holds.ties).map(|tie| format!("peak.tie_{tie}.tension")).collect())?;
    Ok(Comparison {
        name: name.into(),
        alpha: block.alpha,
        static_threshold: static_threshold(&block),
        friction: block.friction,
        runs: found.counts,
        curve: found.curve(),
        no_curve: found.no_curve(),
        rate: found.rate.as_ref().map(|rate| rate.rate),
        peak_slip: slip,
        peak_tension: tension.map(|tension| tension / (block.mass * block.gravity)),
    })
}

fn sliding_result(
    plan: &Plan,
    compared: usize,
    friction: f64,
    table: &SweepTable,
) -> Result<SlidingResult, AssessError> {
    let limit = plan.states[compared].limit;
    let cases = table.cases(limit)?.cases;
    let exceeded = cases.iter().filter(|case| case.fraction == 1.0).count();
    let runs = Counts { known: cases.len(), exceeded, left_out: table.rows() - cases.len() };
    let mut slips: Vec<f64> = table.numbers("peak.slip")?.into_iter().flatten().collect();
    slips.sort_by(f64::total_cmp);
    let median = |sorted: &[f64]| match sorted {
        [] => 0.0,
        sorted => 0.5 * (sorted[(sorted.len() - 1) / 2] + sorted[sorted.len() / 2]),
    };
    Ok(SlidingResult {
        friction,
        runs,
        slid: slips.iter().filter(|slip| **slip > SLID).count(),
        median_slip: median(&slips),
        greatest_slip: slips.last().copied().unwrap_or(0.0),
    })
}

/// Returns remarks on missing or extrapolated results.
fn remarks(plan: &Plan, report: &Report) -> Vec<String> {
    let mut remarks = plan.left_out.iter().map(|left_out| format!("Not tried: {left_out}.")).collect::<Vec<_>>();
    remarks.extend(
        plan.hazard.iter().flat_map(|(file, curve)| curve.remarks.iter().map(move |r| format!("{file}: {r}."))),
    );
    for state in &report.states {
        if let Some(rate) = state.rate {
            let percent = |share: f64| format!("{:.0} %", 100.0 * share);
            let shares = [
                (rate.above_runs, "ground motions stronger than any in the runs; add greater levels to the study"),
                (rate.below_runs, "ground motions weaker than any in the runs; add smaller levels to the study"),
                (rate.outside_hazard, "levels beyond the hazard curve, which was continued"),
            ];
            let notable = shares.into_iter().filter(|(share, _)| *share >= NOTABLE);
            remarks.extend(notable.map(|(share, from)| {
                format!("{} of the annual rate of the state “{}” comes from {from}.", percent(share), state.name)
            }));
        }
        if state.runs.left_out > 0 {
            remarks.push(format!(
                "{} runs have no known outcome for the state “{}” and are left out of its curve.",
                state.runs.left_out, state.name
            ));
        }
    }
    remarks
}
