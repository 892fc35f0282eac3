//! Figures 6 to 8: histories of rotation, rate and energy under a one-sine pulse.

use std::ops::Range;

use crate::canvas::Mark;
use crate::chart::{Chart, Curve, EVEN_BALANCE, MAX_ROTATION, range};
use crate::figures::figure::{Figure, FigureError, Table, Workers, page};
use crate::figures::parameters::{
    ALPHA, Detail, ENERGY_ETA, ENERGY_XI_V, EPSILON, ETA, HISTORY_DURATION, P, XI_V, block, history_pulse, run,
};
use crate::line_style::LineStyle;
use crate::numerals::short;
use crate::page::Symbol;
use rocking_block::block::BlockError;
use rocking_block::excitation::records::Ground;
use rocking_block::simulation::Ending;
use rocking_studies::run::{History, Row, Run};
use rocking_studies::spectrum::Base;

const COLUMNS: [&str; 15] = [
    "foundation",
    "t [s]",
    "theta/alpha [1]",
    "theta_dot/(alpha p) [1]",
    "v/R0 [1]",
    "N_L/(M g) [1]",
    "N_R/(M g) [1]",
    "regime",
    "energy.total [1]",
    "energy.input [1]",
    "energy.dashpots [1]",
    "energy.impacts [1]",
    "a_gx [m/s2]",
    "peak.theta/alpha [1]",
    "end",
];

/// A quantity of a run over time.
type Value = fn(&Computed, &Row) -> f64;

/// A run with its history.
struct Computed {
    base: Base,
    run: Run,
    history: History,
}

/// The two foundations that a panel of Figures 6 to 8 compares.
#[derive(Clone, Debug, PartialEq)]
pub struct Comparison {
    /// Title.
    pub title: String,
    /// Foundation of the solid curve.
    pub solid: Base,
    /// Foundation of the dashed curve.
    pub dashed: Base,
}

/// Returns the panels of Figure 6, 7 or 8. In 6 and 7 they are pairs of charts; other figures have none.
pub fn comparisons(number: u8) -> Vec<Comparison> {
    let rigid = Base::HOUSNER;
    let support = |eta, xi_v, epsilon| Base::viscoelastic(eta, xi_v, epsilon);
    let for_each_eta = |solid: &dyn Fn(f64) -> Base, dashed: &dyn Fn(f64) -> Base| {
        let comparison =
            |&eta: &f64| Comparison { title: format!("η = {}", short(eta)), solid: solid(eta), dashed: dashed(eta) };
        ETA.iter().map(comparison).collect()
    };
    match number {
        6 => for_each_eta(&|_| rigid, &|eta| support(eta, XI_V, EPSILON[0])),
        7 => for_each_eta(&|eta| support(eta, XI_V, EPSILON[0]), &|eta| support(eta, XI_V, EPSILON[1])),
        8 => {
            let pairs = EPSILON.into_iter().flat_map(|epsilon| ENERGY_XI_V.map(|xi_v| (epsilon, xi_v)));
            let comparison = |(epsilon, xi_v)| Comparison {
                title: format!("ε = {}, ξ_v = {}", short(epsilon), short(xi_v)),
                solid: rigid,
                dashed: support(ENERGY_ETA, xi_v, epsilon),
            };
            pairs.map(comparison).collect()
        }
        _ => Vec::new(),
    }
}

/// Returns the foundations of a figure, each once.
pub fn bases(number: u8) -> Vec<Base> {
    let mut bases = Vec::new();
    for comparison in comparisons(number) {
        for base in [comparison.solid, comparison.dashed] {
            if !bases.contains(&base) {
                bases.push(base);
            }
        }
    }
    bases
}

/// Returns the run on a foundation of Figures 6 to 8.
///
/// # Errors
/// An invalid block.
pub fn history_run(base: Base, detail: &Detail) -> Result<Run, BlockError> {
    let run = run(block(ALPHA, P, base)?, history_pulse(), Ground::default());
    Ok(Run { duration: Some(HISTORY_DURATION), output_step: detail.step, ..run })
}

/// Makes Figure 6, 7 or 8.
pub fn figure(number: u8, detail: &Detail, workers: &mut Workers) -> Result<Figure, FigureError> {
    let bases = bases(number);
    let computed = workers.map(bases.len() as u64, |task| -> Result<Computed, FigureError> {
        let base = bases[task as usize];
        let run = history_run(base, detail)?;
        let history = run.history(|_| ())?;
        Ok(Computed { base, run, history })
    });
    let computed: Vec<Computed> = computed.into_iter().collect::<Result<_, _>>()?;
    let pairs: Vec<Pair> = comparisons(number)
        .into_iter()
        .filter_map(|Comparison { title, solid, dashed }| {
            let find = |base| computed.iter().find(|computed| computed.base == base);
            Some(Pair { title, solid: find(solid)?, dashed: find(dashed)? })
        })
        .collect();
    let svg = if number == 8 { energies(&pairs)? } else { rotations(number, &pairs)? };
    table(number, &computed)?.figure(svg, 0)
}

fn table(number: u8, computed: &[Computed]) -> Result<Table, FigureError> {
    let mut lines: Vec<String> = computed.iter().map(|run| format!("foundation {}: {}", run.base, run.end())).collect();
    lines.push("energies over M g R0 (1 - cos alpha); a foundation is eta,xi_v,epsilon".into());
    let mut table = Table::new(number, &lines, COLUMNS)?;
    for computed in computed {
        let block = &computed.run.block;
        let (weight, scale) = (block.mass * block.gravity, computed.energy_scale());
        for row in &computed.history.rows {
            let numbers = [
                row.time,
                row.observation.theta / block.alpha,
                row.observation.theta_dot / (block.alpha * block.p),
                row.observation.v / block.r0,
                row.observation.reaction[0] / weight,
                row.observation.reaction[1] / weight,
                row.regime.number().into(),
                row.energies.total / scale,
                row.energies.input / scale,
                row.energies.dashpots / scale,
                row.energies.impacts / scale,
                row.ground[0],
                computed.peak(),
            ];
            let fields = numbers.map(|number| number.to_string());
            table.push([computed.base.to_string()].into_iter().chain(fields).chain([computed.end()]))?;
        }
    }
    Ok(table)
}

impl Computed {
    /// Returns the peak |θ|/α of the run.
    fn peak(&self) -> f64 {
        self.history.peaks.theta / self.run.block.alpha
    }

    /// Returns M g R0 (1 − cos α) (J), the energy that overturns the block slowly.
    fn energy_scale(&self) -> f64 {
        let block = &self.run.block;
        block.mass * block.gravity * block.r0 * (1.0 - libm::cos(block.alpha))
    }

    fn end(&self) -> String {
        match self.history.ending {
            None => "completed".into(),
            Some((Ending::Separated, time)) => format!("separated at {time:.3} s"),
            Some((Ending::Toppled | Ending::Overturned, time)) => format!("overturned at {time:.3} s"),
        }
    }

    fn curve(&self, style: LineStyle, value: Value) -> Curve {
        let points = self.history.rows.iter().map(|row| (row.time, value(self, row))).collect();
        Curve { style, segments: vec![points], ends: self.history.ending.is_some() }
    }
}

/// A comparison with its runs.
struct Pair<'a> {
    title: String,
    solid: &'a Computed,
    dashed: &'a Computed,
}

impl Pair<'_> {
    fn curves(&self, value: Value) -> Vec<Curve> {
        vec![self.solid.curve(LineStyle::WIDE_GREY, value), self.dashed.curve(LineStyle::DASHED, value)]
    }
}

/// Returns the common range of all curves.
fn common_range(pairs: &[Pair], value: Value) -> Range<f64> {
    let all = pairs.iter().flat_map(|pair| [pair.solid, pair.dashed]);
    range(all.flat_map(|computed| computed.history.rows.iter().map(move |row| value(computed, row))))
}

/// Draws rotation and rate, a row per pair.
fn rotations(number: u8, pairs: &[Pair]) -> Result<String, FigureError> {
    const HEIGHT: u32 = 5600;
    let theta: Value = |computed, row| row.observation.theta / computed.run.block.alpha;
    let rate: Value = |computed, row| row.observation.theta_dot / (computed.run.block.alpha * computed.run.block.p);
    let [angles, rates] = [theta, rate].map(|value| common_range(pairs, value));
    let angles = angles.start.max(-MAX_ROTATION)..angles.end.min(MAX_ROTATION);
    let [solid, dashed] = match number {
        6 => ["rigid base".into(), "viscoelastic supports".into()],
        _ => EPSILON.map(|epsilon| format!("ε = {}", short(epsilon))),
    };
    let mut legend = vec![
        (Symbol::Curve(LineStyle::WIDE_GREY), solid),
        (Symbol::Curve(LineStyle::DASHED), dashed),
        (Symbol::Band, "|θ| ≤ β".into()),
    ];
    if pairs.iter().any(|pair| [pair.solid, pair.dashed].iter().any(|computed| computed.history.ending.is_some())) {
        legend.push((Symbol::Mark(Mark::Cross), "complete separation".into()));
    }
    page(number, &legend, HEIGHT * pairs.len() as u32, |root, body| {
        for (area, pair) in body.split_evenly((pairs.len(), 1)).iter().zip(pairs) {
            let (left, right) = area.split_horizontally(area.dim_in_pixel().0 / 2);
            let block = &pair.dashed.run.block;
            let beta = block.separation_angle() / block.alpha;
            let peaks = [pair.solid, pair.dashed].map(|computed| match computed.history.ending {
                None => format!("{:.3}", computed.peak()),
                Some(_) => computed.end(),
            });
            let title = format!("{}: peak |θ|/α = {} (solid), {} (dashed)", pair.title, peaks[0], peaks[1]);
            let chart = |title, name, value, span: &Range<f64>, band| Chart {
                title,
                x: ("t (s)", 0.0..HISTORY_DURATION),
                y: (name, span.clone()),
                band,
                curves: pair.curves(value),
                ..Chart::default()
            };
            let rotation = chart(title, "θ/α", theta, &angles, Some(-beta..beta));
            Chart { balance: Some(EVEN_BALANCE), ..rotation }.draw(root, &left)?;
            chart(pair.title.clone(), "θ̇/(α p)", rate, &rates, None).draw(root, &right)?;
        }
        Ok(())
    })
}

/// Draws the total energy, a panel per pair.
fn energies(pairs: &[Pair]) -> Result<String, FigureError> {
    const HEIGHT: u32 = 7000;
    let total: Value = |computed, row| row.energies.total / computed.energy_scale();
    let span = common_range(pairs, total);
    let legend = [
        (Symbol::Curve(LineStyle::WIDE_GREY), "rigid base".into()),
        (Symbol::Curve(LineStyle::DASHED), "viscoelastic supports".into()),
    ];
    let rows = pairs.len().div_ceil(2);
    page(8, &legend, HEIGHT * rows as u32, |root, body| {
        for (area, pair) in body.split_evenly((rows, 2)).iter().zip(pairs) {
            let chart = Chart {
                title: pair.title.clone(),
                x: ("t (s)", 0.0..HISTORY_DURATION),
                y: ("E/[M g R0 (1 − cos α)]", span.clone()),
                curves: pair.curves(total),
                ..Chart::default()
            };
            chart.draw(root, area)?;
        }
        Ok(())
    })
}
