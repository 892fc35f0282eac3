//! A plan → its results.

use std::collections::BTreeSet;

use rayon::ThreadPool;

use crate::assess::alternatives::{Alternative, Assumption};
use crate::assess::describe::{building, hazard_result, motions, object, strengths};
use crate::assess::plan::{Hazard, Plan};
use crate::assess::results::{Comparison, Report, Sensitivity, SlidingResult};
use crate::assess::spectrum::SizeSpectrum;
use crate::assess::states::{CONFIDENCE, StateCurve};
use crate::assess::steps::{AssessError, Cache, Step, Work};
use crate::assess::{pulses, spectrum};
use crate::fragility::{Assessment, Component, Direction, Limit, SweepTable};
use crate::input::parameters::Vocabulary;
use crate::output::runner::Study;
use crate::spec::words::Words;
use crate::spectrum::CheckedSpectrum;
use crate::spectrum::statistics::{BlockOutcome, Statistics};
use crate::sweep::change::Change;
use rocking_block::block::restraints::LinkKind;
use rocking_block::numerics::wide::VectorWidth;

/// Coefficients of friction of the runs that slide. Most pairs of `rocking foundations` lie between the first and the last.
const FRICTIONS: [f64; 3] = [0.3, 0.5, 0.7];
/// Slip (m) that counts as sliding.
const SLID: f64 = 1e-3;
/// Share of an annual rate beyond the runs or the hazard that draws a remark.
const NOTABLE: f64 = 0.01;
/// Probability of a deviance below which the poor fit of a curve draws a remark.
const POOR_FIT: f64 = 0.05;
/// Factor on a ground motion above which its scaling draws a remark.
const USUAL_SCALE: f64 = 4.0;

/// The results of an assessment: the numbers, and the data of its pictures.
pub struct Results {
    /// The numbers.
    pub report: Report,
    /// The table of the runs.
    pub table: SweepTable,
    /// The curve of each state.
    pub states: Vec<StateCurve>,
    /// Blocks of the object's shape in other sizes, in the plane.
    pub sizes: Option<SizeSpectrum>,
    /// The steps of the work.
    pub steps: Vec<Step>,
}

/// Makes all runs of a plan on a pool and evaluates them.
///
/// Runs are stepped in vectors of this width; the results depend neither on that nor on the threads. A folder keeps the rows for further
/// calls. `progress` receives the name of the step, the number of finished runs and their total, which grows as the searches proceed.
///
/// # Errors
/// The folder cannot be written.
pub fn assess(
    plan: &Plan,
    pool: &ThreadPool,
    width: Option<VectorWidth>,
    keep: Option<Cache>,
    progress: &(dyn Fn(&str, u64, u64) + Sync),
) -> Result<Results, AssessError> {
    let Plan { sweep, measure, states, years, .. } = plan;
    let frictions = frictions(plan);
    let of_sizes = spectrum::of(plan)?;
    let sweeps = 1 + plan.variants.len() + frictions.len() + 2 * plan.assumptions.len();
    let all = sweeps as u64 * sweep.rows()
        + of_sizes.as_ref().map_or(0, |(spectrum, _)| spectrum.rows())
        + (plan.pulse_periods.len() * pulses::places(plan).len()) as u64 * pulses::POINTS;
    let mut work = Work::new(pool, width, keep, all, progress);

    let table = work.sweep("the object", sweep)?;
    let hazard = plan.hazard.as_ref().map(|hazard| &hazard.curve);
    let curves = states.iter().map(|state| StateCurve::new(&table, *measure, state.limit, hazard));
    let curves = curves.collect::<Result<Vec<_>, _>>()?;
    let compared = curves.iter().rposition(|curve| curve.assessment.is_ok()).unwrap_or(states.len() - 1);
    let compare = |name: &str, changes: &[Change], table: &SweepTable| comparison(plan, compared, name, changes, table);
    let changed = |work: &mut Work, name: &str, changes: &[Change]| -> Result<Comparison, AssessError> {
        compare(name, changes, &work.sweep(name, &sweep.with(changes))?)
    };
    let mut variants = vec![compare("as it is", &[], &table)?];
    for Alternative { name, changes } in &plan.variants {
        variants.push(changed(&mut work, name, changes)?);
    }
    let mut sliding = Vec::new();
    for &friction in &frictions {
        let changes = [of_friction(plan, friction)];
        let table = work.sweep(&format!("friction {friction}"), &sweep.with(&changes))?;
        sliding.push(sliding_result(plan, compared, friction, &table)?);
    }
    if slides(plan) {
        sliding.push(sliding_result(plan, compared, plan.object.friction(), &table)?);
    }
    let mut sensitivity = Vec::new();
    for assumption in &plan.assumptions {
        let Assumption { name, changes, .. } = assumption;
        let ends = [changed(&mut work, name, &changes[..1])?, changed(&mut work, name, &changes[1..])?];
        sensitivity.push(Sensitivity { assumption: assumption.clone(), ends });
    }
    let sizes = of_sizes.map(|of_sizes| other_sizes(&mut work, of_sizes)).transpose()?;
    let pulses = work.search("pulses", |ran| pulses::least(plan, width, ran));
    let results: Vec<_> =
        states.iter().zip(&curves).map(|(state, curve)| curve.result(state, hazard, *years)).collect();
    let intervals = curves.iter().find_map(|curve| curve.assessment.as_ref().ok());
    let mut report = Report {
        title: plan.title.clone(),
        author: plan.author.clone(),
        date: plan.date.clone(),
        study: plan.file.clone(),
        object: object(plan),
        building: building(plan),
        motions: motions(plan),
        reversed: sweep.motions.iter().filter(|motion| motion.is_reversed).count(),
        blocks: sweep.combinations().unwrap_or(0),
        strengths: strengths(sweep),
        runs: sweep.rows(),
        im: measure.heading(),
        pulse: plan.pulse.word().into(),
        pulses,
        sizes: sizes.as_ref().map(SizeSpectrum::results).unwrap_or_default(),
        sizes_strength: sizes.as_ref().map(|sizes| sizes.strength.clone()).unwrap_or_default(),
        directions: directions(plan, &table, states[compared].limit)?,
        states: results,
        confidence: CONFIDENCE,
        intervals: intervals.map(Assessment::intervals),
        hazard: plan.hazard.as_ref().map(hazard_result),
        years: *years,
        compared_state: compared,
        variants,
        sliding,
        sensitivity,
        remarks: Vec::new(),
        inputs: plan.inputs.clone(),
    };
    report.remarks = remarks(plan, &report, &curves);
    Ok(Results { report, table, states: curves, sizes, steps: work.steps })
}

/// Makes the spectrum of blocks in other sizes, under ground motions of a strength in words.
fn other_sizes(work: &mut Work, of: (CheckedSpectrum, String)) -> Result<SizeSpectrum, AssessError> {
    let (spectrum, strength) = of;
    let table = work.table("other sizes", &spectrum, &spectrum.header().study)?;
    let mut statistics = Statistics::new(&spectrum);
    statistics.add(&spectrum, &BlockOutcome::all(&table)?);
    Ok(SizeSpectrum { spectrum, table, statistics, strength })
}

/// Returns the runs by direction, of an object in space under several.
fn directions(plan: &Plan, table: &SweepTable, limit: Limit) -> Result<Vec<Direction>, AssessError> {
    let found = plan.object.in_space().map(|_| table.directions(limit)).transpose()?.unwrap_or_default();
    Ok(if found.len() > 1 { found } else { Vec::new() })
}

/// Whether the study limits the friction of its blocks.
fn slides(plan: &Plan) -> bool {
    match plan.object.in_space() {
        Some(_) => plan.sweep.parameters.iter().any(|swept| swept.parameter.is_friction()),
        None => plan.sweep.holds().friction,
    }
}

/// The change to a coefficient of friction.
fn of_friction(plan: &Plan, friction: f64) -> Change {
    let vocabulary = if plan.object.in_space().is_some() { Vocabulary::Space } else { Vocabulary::Plane };
    let parameter = vocabulary.parameter("friction").unwrap_or_else(|message| unreachable!("{message}"));
    Change::of_parameter(&parameter, friction)
}

/// Returns the coefficients of friction to try. There are none for a study with friction, or if a corner could jam.
fn frictions(plan: &Plan) -> Vec<f64> {
    let fits = |friction: &f64| !slides(plan) && plan.sweep.check_changes(&[of_friction(plan, *friction)]).is_ok();
    FRICTIONS.into_iter().filter(fits).collect()
}

/// Returns a variant relative to the compared state.
fn comparison(
    plan: &Plan,
    compared: usize,
    name: &str,
    changes: &[Change],
    table: &SweepTable,
) -> Result<Comparison, AssessError> {
    let hazard = plan.hazard.as_ref().map(|hazard| &hazard.curve);
    let limit = match plan.states[compared].limit {
        // For an object with ties, overturning is a choice of the study.
        Limit::Overturned if !plan.sweep.holds().has_links() => table.usual_limit(),
        limit => limit,
    };
    let found = StateCurve::new(table, plan.measure, limit, hazard)?;
    let sweep = plan.sweep.with(changes);
    let object = plan.values.object(&sweep)?;
    let holds = sweep.holds();
    let greatest = |columns: Vec<String>| -> Result<Option<f64>, AssessError> {
        let mut found: Option<f64> = None;
        for column in columns {
            found = table.numbers(&column)?.into_iter().flatten().chain(found).reduce(f64::max);
        }
        Ok(found)
    };
    let has_slip = if object.in_plane().is_some() { holds.friction } else { object.friction().is_finite() };
    let slip = greatest(has_slip.then(|| "peak.slip".to_string()).into_iter().collect())?;
    let force = |of: LinkKind| {
        let links = holds.links().filter(|(kind, _)| *kind == of);
        let force =
            greatest(links.map(|(kind, i)| format!("peak.{}_{}.{}", kind.word(), i + 1, kind.force())).collect());
        force.map(|force| force.map(|force| force / object.weight()))
    };
    let links = object.in_plane().map(|block| block.ties()).unwrap_or_default();
    let ties = || links.iter().filter(|tie| tie.kind == LinkKind::Tie && tie.is_present());
    let distances = ties().map(|tie| (tie.ground[0] - tie.block[0]).abs()).filter(|distance| *distance > 0.0);
    let can_break = ties().any(|tie| tie.strength > 0.0);
    let broken = can_break.then(|| table.numbers("ties.broken")).transpose()?;
    Ok(Comparison {
        name: name.into(),
        alpha: object.alpha(),
        static_threshold: object.static_threshold(),
        friction: object.friction(),
        limit,
        runs: found.counts,
        curve: found.curve(),
        no_curve: found.assessment.as_ref().err().cloned(),
        rate: found.rate.as_ref().map(|rate| rate.rate),
        rate_of_unknown: found.rate_of_unknown,
        separate_at: found.separate_at,
        peak_slip: slip,
        peak_tension: force(LinkKind::Tie)?,
        peak_damper_force: force(LinkKind::Damper)?,
        anchor_distance: distances.reduce(f64::min),
        runs_with_broken_ties: broken.map(|broken| broken.into_iter().flatten().filter(|count| *count > 0.0).count()),
    })
}

fn sliding_result(
    plan: &Plan,
    compared: usize,
    friction: f64,
    table: &SweepTable,
) -> Result<SlidingResult, AssessError> {
    let (.., counts) = table.cases(plan.states[compared].limit)?;
    let mut slips: Vec<f64> = table.numbers("peak.slip")?.into_iter().flatten().collect();
    slips.sort_by(f64::total_cmp);
    let median = |sorted: &[f64]| match sorted {
        [] => 0.0,
        sorted => 0.5 * (sorted[(sorted.len() - 1) / 2] + sorted[sorted.len() / 2]),
    };
    Ok(SlidingResult {
        friction,
        runs: counts.into(),
        slid: slips.iter().filter(|slip| **slip > SLID).count(),
        median_slip: median(&slips),
        greatest_slip: slips.last().copied().unwrap_or(0.0),
    })
}

/// Returns remarks on the fit of a curve, and on curves that cross.
fn remarks_on_curves(plan: &Plan, curves: &[StateCurve]) -> Vec<String> {
    let fitted =
        || plan.states.iter().zip(curves).filter_map(|(state, curve)| Some((state, curve.assessment.as_ref().ok()?)));
    let mut remarks = Vec::new();
    for (state, found) in fitted() {
        remarks.extend(
            found.warnings(&format!("“{}” over {}", state.name, plan.measure)).into_iter().map(|text| text + "."),
        );
        if let Some(goodness) = found.goodness().filter(|goodness| goodness.p < POOR_FIT) {
            remarks.push(format!(
                "The curve of the state “{}” fits its runs poorly: of samples of a true curve, less than {:.1} % deviate as far.",
                state.name,
                (1000.0 * goodness.p).ceil().max(1.0) / 10.0
            ));
        }
    }
    let fits = fitted().map(|(state, found)| (state.limit, &found.fit));
    if let Ok(component) = Component::new("curves", plan.measure, 1.0, fits, "") {
        remarks.extend(component.crossings().into_iter().map(|crossing| {
            let named = plan
                .states
                .iter()
                .fold(crossing, |text, state| text.replace(&state.limit.to_string(), &format!("“{}”", state.name)));
            format!("States: {}.", named.trim_start_matches("curves: "))
        }));
    }
    remarks
}

/// Returns remarks on strong scaling, and on what the motions do to links and walls.
fn remarks_on_motions(report: &Report) -> Vec<String> {
    let mut remarks = Vec::new();
    let strongest = report.motions.iter().max_by(|a, b| a.scales[1].total_cmp(&b.scales[1]));
    if let Some(motion) = strongest.filter(|motion| motion.scales[1] > USUAL_SCALE) {
        let scaled = report.motions.iter().filter(|motion| motion.scales[1] > USUAL_SCALE);
        let scaled = scaled.map(|motion| &motion.motion).collect::<BTreeSet<_>>().len();
        remarks.push(format!(
            "Scaling makes {scaled} of {} ground motions more than {USUAL_SCALE} times stronger, {} up to {:.1} times: a strong earthquake lasts \
             longer and shakes more slowly than a weak one made stronger. Records of stronger earthquakes avoid this.",
            report.independent_motions(),
            motion.name,
            motion.scales[1]
        ));
    }
    let listed = |text: &dyn Fn(&Comparison) -> Option<String>| {
        let texts: Vec<String> = report.variants.iter().filter_map(text).collect();
        (!texts.is_empty()).then(|| texts.join(", "))
    };
    let tension = |variant: &Comparison| {
        let tension = variant.peak_tension.filter(|tension| *tension > 1.0)?;
        Some(format!("{tension:.1} times in “{}”", variant.name))
    };
    remarks.extend(listed(&tension).map(|tensions| {
        format!("A tie pulls with more than the weight of the object, up to {tensions}: anchors, wall and object must carry it.")
    }));
    let slip = |variant: &Comparison| {
        let (slip, distance) =
            variant.peak_slip.zip(variant.anchor_distance).filter(|(slip, distance)| slip > distance)?;
        Some(format!("{slip:.2} m where an anchor is {distance:.2} m away in “{}”", variant.name))
    };
    remarks.extend(listed(&slip).map(|slips| {
        format!(
            "The object slips as far as the wall that holds its ties, which the computation does not know: {slips}."
        )
    }));
    remarks
}

/// Returns remarks on missing, doubtful or extrapolated results.
fn remarks(plan: &Plan, report: &Report, curves: &[StateCurve]) -> Vec<String> {
    let mut remarks = plan.left_out.iter().map(|left_out| format!("Not tried: {left_out}.")).collect::<Vec<_>>();
    remarks.extend(
        plan.hazard
            .iter()
            .flat_map(|Hazard { file, curve, .. }| curve.remarks.iter().map(move |r| format!("{file}: {r}."))),
    );
    for state in &report.states {
        if let Some(rate) = state.rate {
            let percent = |fraction: f64| format!("{:.0} %", 100.0 * fraction);
            let fractions = [
                (rate.above_runs, "ground motions stronger than any in the runs; add greater levels to the study"),
                (rate.below_runs, "ground motions weaker than any in the runs; add smaller levels to the study"),
                (rate.outside_hazard, "levels beyond the hazard curve, which was continued"),
            ];
            let notable = fractions.into_iter().filter(|(fraction, _)| *fraction >= NOTABLE);
            remarks.extend(notable.map(|(fraction, from)| {
                format!("{} of the annual rate of the state “{}” comes from {from}.", percent(fraction), state.name)
            }));
        }
        if state.runs.left_out > 0 {
            remarks.push(format!(
                "{} runs have no known outcome for the state “{}” and are left out of its curve: {} to {} of all {} runs exceed it.",
                state.runs.left_out,
                state.name,
                state.runs.exceeded,
                state.runs.at_most(),
                state.runs.all()
            ));
            if let Some(rates) = state.rate.and_then(|rate| rate.rate_of_unknown) {
                let [none, all] =
                    rates.map(|rate| rate.map_or("not computable".into(), |rate| format!("{rate:.1e} per year")));
                remarks.push(format!(
                    "The annual rate of the state “{}” is {none} if none of these runs exceeds it, and {all} if all do.",
                    state.name
                ));
            }
        }
    }
    remarks.extend(remarks_on_curves(plan, curves));
    remarks.extend(remarks_on_motions(report));
    remarks
}
