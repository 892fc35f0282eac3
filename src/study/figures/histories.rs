//! Figures 6 to 8: histories of rotation, its rate and energy under a one-sine pulse.

use crate::block::BlockError;
use crate::records::ground::Ground;
use crate::simulation::{Ending, Initial, Settings};
use crate::study::chart::{Chart, Curve, MOST_ROTATION, Sample, range};
use crate::study::figures::page::page;
use crate::study::figures::parameters::{
    ALPHA, Detail, ENERGY_ETA, ENERGY_XI_V, EPSILON, ETA, HISTORY_DURATION, P, XI_V, block, history_pulse,
};
use crate::study::figures::table::Table;
use crate::study::figures::{Figure, FigureError, Work};
use crate::study::history::{History, Row, Run};
use crate::study::look::Look;
use crate::study::numerals::short;
use crate::study::spectrum::Base;

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

/// What a chart shows of a run.
type Value = fn(&Made, &Row) -> f64;

/// A run, and what it did.
struct Made {
    base: Base,
    run: Run,
    history: History,
}

/// The two foundations that a panel of Figures 6 to 8 compares.
#[derive(Clone, Debug, PartialEq)]
pub struct Comparison {
    /// What stands over it.
    pub title: String,
    /// The foundation that is drawn solid.
    pub solid: Base,
    /// The foundation that is drawn dashed.
    pub dashed: Base,
}

/// The panels of Figures 6 to 8 (in 6 and 7 a pair for each of them); of another figure, none.
pub fn comparisons(number: u8) -> Vec<Comparison> {
    let rigid = Base::HOUSNER;
    let support = |eta, xi_v, epsilon| Base::Viscoelastic { eta, xi_v, epsilon };
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

/// The foundations of a figure, each once.
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

/// The run of a block of Figures 6 to 8.
pub fn history_run(base: Base, detail: &Detail) -> Result<Run, BlockError> {
    Ok(Run {
        block: block(ALPHA, P, base)?,
        settings: Settings::default(),
        initial: Initial::default(),
        pulse: history_pulse(),
        ground: Ground::default(),
        duration: Some(HISTORY_DURATION),
        output_step: detail.step,
    })
}

/// Makes Figure 6, 7 or 8.
pub fn figure(number: u8, caption: &str, detail: &Detail, work: &mut Work) -> Result<Figure, FigureError> {
    let bases = bases(number);
    let made: Vec<Made> = work
        .make(bases.len() as u64, |task| -> Result<Made, FigureError> {
            let base = bases[task as usize];
            let run = history_run(base, detail)?;
            let history = run.history(|_| ())?;
            Ok(Made { base, run, history })
        })
        .into_iter()
        .collect::<Result<_, _>>()?;
    let pairs: Vec<Pair> = comparisons(number)
        .into_iter()
        .filter_map(|Comparison { title, solid, dashed }| {
            let of = |base| made.iter().find(|made| made.base == base);
            Some(Pair { title, solid: of(solid)?, dashed: of(dashed)? })
        })
        .collect();
    let svg = if number == 8 { energies(caption, &pairs)? } else { motions(number, caption, &pairs)? };
    Ok(Figure { number, svg, table: table(number, caption, &made)?, failed: 0 })
}

fn table(number: u8, caption: &str, made: &[Made]) -> csv::Result<String> {
    let mut lines: Vec<String> = made.iter().map(|made| format!("foundation {}: {}", made.base, made.end())).collect();
    lines.push("energies over M g R0 (1 - cos alpha); a foundation is eta,xi_v,epsilon".into());
    let mut table = Table::new(number, caption, &lines, &COLUMNS)?;
    for made in made {
        let block = &made.run.block;
        let (weight, scale) = (block.mass * block.gravity, made.energy_scale());
        for row in &made.history.rows {
            let numbers = [
                row.time,
                row.seen.theta / block.alpha,
                row.seen.theta_dot / (block.alpha * block.p),
                row.seen.v / block.r0,
                row.seen.reaction[0] / weight,
                row.seen.reaction[1] / weight,
                row.regime.number().into(),
                row.energies.total / scale,
                row.energies.input / scale,
                row.energies.dashpots / scale,
                row.energies.impacts / scale,
                row.ground[0],
                made.peak(),
            ];
            let fields = numbers.map(|number| number.to_string());
            table.push([made.base.to_string()].into_iter().chain(fields).chain([made.end()]))?;
        }
    }
    table.finish()
}

impl Made {
    /// Peak |θ|/α until the end of the run.
    fn peak(&self) -> f64 {
        self.history.peaks.theta / self.run.block.alpha
    }

    /// M g R0 (1 − cos α) (J): what it takes to overturn the block slowly.
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

    fn curve(&self, look: Look, value: impl Fn(&Row) -> f64) -> Curve {
        let points = self.history.rows.iter().map(|row| (row.time, value(row))).collect();
        Curve { look, pieces: vec![points], ends: self.history.ending.is_some() }
    }
}

/// A comparison with its runs.
struct Pair<'a> {
    title: String,
    solid: &'a Made,
    dashed: &'a Made,
}

impl Pair<'_> {
    fn curves(&self, value: Value) -> Vec<Curve> {
        let Pair { solid, dashed, .. } = self;
        vec![solid.curve(Look::SOLID, |row| value(solid, row)), dashed.curve(Look::DASHED, |row| value(dashed, row))]
    }
}

/// A range in which all curves fit.
fn common_range(pairs: &[Pair], value: Value) -> std::ops::Range<f64> {
    let all = pairs.iter().flat_map(|pair| [pair.solid, pair.dashed]);
    range(all.flat_map(|made| made.history.rows.iter().map(move |row| value(made, row))))
}

/// Rotation and its rate, a row for each pair.
fn motions(number: u8, caption: &str, pairs: &[Pair]) -> Result<String, FigureError> {
    const HEIGHT: u32 = 5600;
    let theta: Value = |made, row| row.seen.theta / made.run.block.alpha;
    let rate: Value = |made, row| row.seen.theta_dot / (made.run.block.alpha * made.run.block.p);
    let [angles, rates] = [theta, rate].map(|value| common_range(pairs, value));
    let angles = angles.start.max(-MOST_ROTATION)..angles.end.min(MOST_ROTATION);
    let [solid, dashed] = match number {
        6 => ["rigid base".into(), "viscoelastic supports".into()],
        _ => EPSILON.map(|epsilon| format!("ε = {}", short(epsilon))),
    };
    let mut samples = vec![
        (Sample::Curve(Look::SOLID), solid),
        (Sample::Curve(Look::DASHED), dashed),
        (Sample::Band, "|θ| ≤ β".into()),
    ];
    if pairs.iter().any(|pair| [pair.solid, pair.dashed].iter().any(|made| made.history.ending.is_some())) {
        samples.push((Sample::Cross, "complete separation".into()));
    }
    let svg = page(number, caption, &samples, HEIGHT * pairs.len() as u32, |root, body| {
        for (area, pair) in body.split_evenly((pairs.len(), 1)).iter().zip(pairs) {
            let (left, right) = area.split_horizontally(area.dim_in_pixel().0 / 2);
            let block = &pair.dashed.run.block;
            let beta = block.separation_angle() / block.alpha;
            let peaks = [pair.solid, pair.dashed].map(|made| match made.history.ending {
                None => format!("{:.3}", made.peak()),
                Some(_) => made.end(),
            });
            let title = format!("{}: peak |θ|/α = {} (solid), {} (dashed)", pair.title, peaks[0], peaks[1]);
            let chart = |title, name, value, span: &std::ops::Range<f64>, band| Chart {
                title,
                x: ("t (s)", 0.0..HISTORY_DURATION),
                y: (name, span.clone()),
                band,
                curves: pair.curves(value),
                ..Chart::default()
            };
            let rotation = chart(title, "θ/α", theta, &angles, Some(-beta..beta));
            Chart { marks_alpha: true, ..rotation }.draw(root, &left)?;
            chart(pair.title.clone(), "θ̇/(α p)", rate, &rates, None).draw(root, &right)?;
        }
        Ok(())
    })?;
    Ok(svg)
}

/// Total energy, a panel for each pair.
fn energies(caption: &str, pairs: &[Pair]) -> Result<String, FigureError> {
    const HEIGHT: u32 = 7000;
    let total: Value = |made, row| row.energies.total / made.energy_scale();
    let span = common_range(pairs, total);
    let samples = [
        (Sample::Curve(Look::SOLID), "rigid base".into()),
        (Sample::Curve(Look::DASHED), "viscoelastic supports".into()),
    ];
    let rows = pairs.len().div_ceil(2);
    let svg = page(8, caption, &samples, HEIGHT * rows as u32, |root, body| {
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
    })?;
    Ok(svg)
}
