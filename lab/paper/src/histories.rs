//! Figures 6 to 8: histories of rotation, rate and energy under a one-sine pulse.

use std::ops::Range;

use crate::figure::{self, Figure, FigureError, page};
use crate::parameters::{
    ALPHA, Detail, ENERGY_ETA, ENERGY_XI_V, EPSILON, ETA, HISTORY_DURATION, P, XI_V, block, history_pulse, run,
};
use rocking_block::block::BlockError;
use rocking_block::excitation::records::Ground;
use rocking_block::simulation::Ending;
use rocking_charts::canvas::Mark;
use rocking_charts::chart::{Chart, Curve, EVEN_BALANCE, MAX_ROTATION, range};
use rocking_charts::line_style::LineStyle;
use rocking_charts::numerals::short;
use rocking_charts::page::Symbol;
use rocking_studies::output::runner::in_parallel;
use rocking_studies::output::table::TableColumn;
use rocking_studies::run::{History, Row, Run};
use rocking_studies::spectrum::FoundationCurve;

/// A quantity of a run over time.
type Value = fn(&Computed, &Row) -> f64;

/// A run with its history.
struct Computed {
    base: FoundationCurve,
    run: Run,
    history: History,
}

/// The two foundations that a panel of Figures 6 to 8 compares, or their runs.
#[derive(Clone, Debug, PartialEq)]
pub struct Comparison<Side = FoundationCurve> {
    /// Title.
    pub title: String,
    /// That of the solid curve.
    pub solid: Side,
    /// That of the dashed curve.
    pub dashed: Side,
}

/// Returns the panels of Figure 6, 7 or 8. In 6 and 7 they are pairs of charts; other figures have none.
pub fn comparisons(number: u8) -> Vec<Comparison> {
    let rigid = FoundationCurve::HOUSNER;
    let support = |eta, xi_v, epsilon| FoundationCurve::viscoelastic(eta, xi_v, epsilon);
    let for_each_eta = |solid: &dyn Fn(f64) -> FoundationCurve, dashed: &dyn Fn(f64) -> FoundationCurve| {
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
pub fn bases(number: u8) -> Vec<FoundationCurve> {
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
pub fn history_run(base: FoundationCurve, detail: &Detail) -> Result<Run, BlockError> {
    let run = run(block(ALPHA, P, base)?, history_pulse(), Ground::default());
    Ok(Run { duration: Some(HISTORY_DURATION), output_step: detail.step, ..run })
}

/// Makes Figure 6, 7 or 8.
pub fn figure(number: u8, detail: &Detail) -> Result<Figure, FigureError> {
    let bases = bases(number);
    let computed = in_parallel(bases.len(), |task| -> Result<Computed, FigureError> {
        let base = bases[task];
        let run = history_run(base, detail)?;
        let history = run.history(|_| ())?;
        Ok(Computed { base, run, history })
    });
    let computed: Vec<Computed> = computed.into_iter().collect::<Result<_, _>>()?;
    let pairs: Vec<Comparison<&Computed>> = comparisons(number)
        .into_iter()
        .filter_map(|Comparison { title, solid, dashed }| {
            let find = |base| computed.iter().find(|computed| computed.base == base);
            Some(Comparison { title, solid: find(solid)?, dashed: find(dashed)? })
        })
        .collect();
    let svg = if number == 8 { energies(&pairs)? } else { rotations(number, &pairs)? };
    with_table(number, &computed, svg)
}

fn with_table(number: u8, computed: &[Computed], svg: String) -> Result<Figure, FigureError> {
    let mut lines: Vec<String> = computed.iter().map(|run| format!("foundation {}: {}", run.base, run.end())).collect();
    lines.push("energies over M g R0 (1 - cos alpha); a foundation is eta,xi_v,epsilon".into());
    let real = |name: &str, unit: &str, value: Value| {
        TableColumn::real(name, unit, move |(computed, row): &(&Computed, &Row)| value(computed, row))
    };
    let columns = [
        TableColumn::text("foundation", |(computed, _): &(&Computed, &Row)| computed.base.to_string()),
        real("t", "s", |_, row| row.time),
        real("theta/alpha", "1", Computed::theta),
        real("theta_dot/(alpha p)", "1", Computed::rate),
        real("v/R0", "1", |computed, row| row.observation.v / computed.run.block.r0),
        real("N_L/(M g)", "1", |computed, row| row.observation.reaction[0] / computed.weight()),
        real("N_R/(M g)", "1", |computed, row| row.observation.reaction[1] / computed.weight()),
        real("regime", "", |_, row| row.regime.number().into()).with_unit(None),
        real("energy.total", "1", |computed, row| row.energies.total / computed.energy_scale()),
        real("energy.input", "1", |computed, row| row.energies.input / computed.energy_scale()),
        real("energy.dashpots", "1", |computed, row| row.energies.dashpots / computed.energy_scale()),
        real("energy.impacts", "1", |computed, row| row.energies.impacts / computed.energy_scale()),
        real("a_gx", "m/s2", |_, row| row.ground[0]),
        real("peak.theta/alpha", "1", |computed, _| computed.peak()),
        TableColumn::text("end", |(computed, _): &(&Computed, &Row)| computed.end()),
    ];
    let rows: Vec<(&Computed, &Row)> =
        computed.iter().flat_map(|run| run.history.rows.iter().map(move |row| (run, row))).collect();
    figure::figure(number, &lines, &columns, &rows, svg)
}

impl Computed {
    /// Returns the peak |θ|/α of the run.
    fn peak(&self) -> f64 {
        self.history.peaks.theta / self.run.block.alpha
    }

    /// Returns θ/α.
    fn theta(&self, row: &Row) -> f64 {
        row.observation.theta / self.run.block.alpha
    }

    /// Returns θ̇/(α p).
    fn rate(&self, row: &Row) -> f64 {
        row.observation.theta_dot / (self.run.block.alpha * self.run.block.p)
    }

    /// Returns M g (N).
    fn weight(&self) -> f64 {
        self.run.block.mass * self.run.block.gravity
    }

    /// Returns M g R0 (1 − cos α) (J), the energy that overturns the block slowly.
    fn energy_scale(&self) -> f64 {
        self.weight() * self.run.block.r0 * (1.0 - libm::cos(self.run.block.alpha))
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

impl Comparison<&Computed> {
    fn runs(&self) -> [&Computed; 2] {
        [self.solid, self.dashed]
    }

    fn curves(&self, value: Value) -> Vec<Curve> {
        vec![self.solid.curve(LineStyle::WIDE_GREY, value), self.dashed.curve(LineStyle::DASHED, value)]
    }
}

/// Returns the common range of all curves.
fn common_range(pairs: &[Comparison<&Computed>], value: Value) -> Range<f64> {
    let all = pairs.iter().flat_map(Comparison::runs);
    range(all.flat_map(|computed| computed.history.rows.iter().map(move |row| value(computed, row))))
}

/// Draws rotation and rate, a row per pair.
fn rotations(number: u8, pairs: &[Comparison<&Computed>]) -> Result<String, FigureError> {
    const HEIGHT: u32 = 5600;
    let [theta, rate]: [Value; 2] = [Computed::theta, Computed::rate];
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
    if pairs.iter().flat_map(Comparison::runs).any(|computed| computed.history.ending.is_some()) {
        legend.push((Symbol::Mark(Mark::Cross), "complete separation".into()));
    }
    page(number, &legend, HEIGHT * pairs.len() as u32, |root, body| {
        for (area, pair) in body.split_evenly((pairs.len(), 1)).iter().zip(pairs) {
            let (left, right) = area.split_horizontally(area.dim_in_pixel().0 / 2);
            let block = &pair.dashed.run.block;
            let beta = block.separation_angle() / block.alpha;
            let peaks = pair.runs().map(|computed| match computed.history.ending {
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
fn energies(pairs: &[Comparison<&Computed>]) -> Result<String, FigureError> {
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
