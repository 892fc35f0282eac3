//! Figure 9: least damping that prevents complete separation in free vibration.

use crate::figure::{self, Figure, FigureError, page};
use crate::parameters::{DAMPING_ALPHA, Detail, EPSILON, ETA, GREATEST_XI_V, P, RATE, block, run};
use rocking_block::block::BlockError;
use rocking_block::excitation::Pulse;
use rocking_block::excitation::records::Ground;
use rocking_block::numerics::wide::VectorWidth;
use rocking_block::simulation::Initial;
use rocking_charts::chart::{Chart, Curve};
use rocking_charts::line_style::LineStyle;
use rocking_charts::numerals::short;
use rocking_studies::output::runner::in_parallel;
use rocking_studies::output::table::TableColumn;
use rocking_studies::run::Run;
use rocking_studies::run::batch::outcomes;
use rocking_studies::run::outcome::End;
use rocking_studies::search::{self, Scan};
use rocking_studies::spectrum::FoundationCurve;

/// Resolution of ξ_v (1).
const RESOLUTION: f64 = 1e-4;

const CURVES: usize = EPSILON.len() * ETA.len();

/// Least damping of a block in free vibration (1); `None` if even [`GREATEST_XI_V`] is too little.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct LeastDamping {
    /// Least ξ_v at and above which the block does not separate completely, except while overturning.
    pub against_separation: Option<f64>,
    /// Least ξ_v without overturning, at it and all greater values.
    pub against_overturning: Option<f64>,
}

/// Searches the least damping of a block.
///
/// # Errors
/// An invalid block at an end of the range.
pub fn least_damping(alpha: f64, eta: f64, epsilon: f64, detail: &Detail) -> Result<LeastDamping, BlockError> {
    let scan = Scan { from: 0.0, to: GREATEST_XI_V, points: detail.dampings, resolution: RESOLUTION };
    let block = block(alpha, P, FoundationCurve::viscoelastic(eta, scan.from, epsilon))?;
    block.with_damping_ratio(scan.to)?;
    let run = |&(_, xi_v): &(usize, f64)| Run {
        initial: Initial { theta_dot: RATE * alpha * P, ..Initial::default() },
        output_step: 0.01,
        // Ratios that are valid at both ends of the range are valid between.
        ..run(
            block.with_damping_ratio(xi_v).unwrap_or_else(|error| unreachable!("{error}")),
            Pulse::NONE,
            Ground::default(),
        )
    };
    let outcomes = |values: &[(usize, f64)]| outcomes(VectorWidth::widest(), values.iter().map(run), || ());
    let found = search::changes(&scan, 1, |values| outcomes(values).iter().map(|outcome| outcome.end).collect());
    let [found] = found.as_slice() else { unreachable!("one search was asked for") };
    Ok(LeastDamping {
        against_separation: found.least_without(End::Separated),
        against_overturning: found.least_without(End::Overturned),
    })
}

/// ε, η and α of a search, and its result.
type SearchRow = ((f64, f64, f64), LeastDamping);

/// Returns ε, η and α of a search.
fn parameters(task: u64, detail: &Detail) -> (f64, f64, f64) {
    let (curve, i) = ((task / detail.slendernesses) as usize, task % detail.slendernesses);
    let fraction = i as f64 / (detail.slendernesses - 1) as f64;
    let alpha = DAMPING_ALPHA[0] + fraction * (DAMPING_ALPHA[1] - DAMPING_ALPHA[0]);
    (EPSILON[curve / ETA.len()], ETA[curve % ETA.len()], alpha)
}

/// Makes the figure.
pub fn figure(detail: &Detail) -> Result<Figure, FigureError> {
    let found = in_parallel(CURVES * detail.slendernesses as usize, |task| {
        let (epsilon, eta, alpha) = parameters(task as u64, detail);
        least_damping(alpha, eta, epsilon, detail)
    });
    let lines = [format!(
        "scanned at {} values of xi_v from 0 to {GREATEST_XI_V}, closed in to {RESOLUTION}, until the block has come down; a word: at {GREATEST_XI_V} still",
        detail.dampings
    )];
    let least_or = |word: &'static str, value: fn(&LeastDamping) -> Option<f64>| {
        move |row: &SearchRow| value(&row.1).map_or(word.into(), |xi_v| xi_v.to_string())
    };
    let columns = [
        TableColumn::real("epsilon", "1", |((epsilon, ..), _): &SearchRow| *epsilon),
        TableColumn::real("eta", "1", |((_, eta, _), _): &SearchRow| *eta),
        TableColumn::real("alpha", "rad", |((.., alpha), _): &SearchRow| *alpha),
        TableColumn::text("least.xi_v", least_or("separated", |least| least.against_separation)).with_unit(Some("1")),
        TableColumn::text("least.xi_v.overturning", least_or("overturned", |least| least.against_overturning))
            .with_unit(Some("1")),
    ];
    let mut rows: Vec<SearchRow> = Vec::new();
    let mut curves: Vec<Vec<Vec<(f64, f64)>>> = vec![vec![Vec::new()]; CURVES];
    for (task, least) in found.into_iter().enumerate() {
        let (least, inputs @ (.., alpha)) = (least?, parameters(task as u64, detail));
        let segments = &mut curves[task / detail.slendernesses as usize];
        match (least.against_separation, segments.last_mut()) {
            (Some(xi_v), Some(segment)) => segment.push((alpha, xi_v)),
            _ => segments.push(Vec::new()),
        }
        rows.push((inputs, least));
    }
    let highest = curves.iter().flatten().flatten().fold(0.0_f64, |high, point| high.max(point.1));
    let svg = page(9, &[], 10_000, |root, body| {
        let areas = body.split_evenly((1, EPSILON.len()));
        for ((area, epsilon), curves) in areas.iter().zip(EPSILON).zip(curves.chunks(ETA.len())) {
            let styles = [LineStyle::DOTTED, LineStyle::DASH_DOTTED, LineStyle::DASHED, LineStyle::BLACK];
            let ends = curves.iter().zip(ETA).filter_map(|(segments, eta)| {
                let &(alpha, xi_v) = segments.last()?.last()?;
                Some(((alpha + 0.003, xi_v), format!("η = {}", short(eta))))
            });
            let chart = Chart {
                title: format!("ε = {}", short(epsilon)),
                // Room for the names of the curves at their ends.
                x: ("α (rad)", DAMPING_ALPHA[0]..DAMPING_ALPHA[1] + 0.05),
                y: ("least ξ_v", 0.0..1.06 * highest.max(1e-9)),
                curves: curves.iter().zip(styles).map(|(curve, style)| Curve::new(style, curve.clone())).collect(),
                notes: ends.collect(),
                ..Chart::default()
            };
            chart.draw(root, area)?;
        }
        Ok(())
    })?;
    figure::figure(9, &lines, &columns, &rows, svg)
}
