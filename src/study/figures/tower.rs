//! Figure 14: peak rotations of the bridge tower on supports of all stiffnesses.

use plotters::prelude::*;
use plotters::style::text_anchor::{HPos, Pos, VPos};

use crate::block::BlockError;
use crate::simulation::{Initial, Settings};
use crate::study::chart::{Area, Drawn, GRID, INK, Sample, TEXT, outline, text};
use crate::study::figures::page::page;
use crate::study::figures::parameters::{PAD_ETA, TOWER_ALPHA, TOWER_ETA, TOWER_P, TOWER_SUPPORT, block};
use crate::study::figures::sources::Source;
use crate::study::figures::table::Table;
use crate::study::figures::{Figure, FigureError, Work};
use crate::study::formula::formula;
use crate::study::history::Run;
use crate::study::look::Look;
use crate::study::numerals::{short, tick};
use crate::study::outcome::{End, Outcome};
use crate::study::spectrum::Base;

/// What the tower stands on: the supports that are drawn as bars, the rigid base, and the pads, which are in the table alone.
pub fn tower_bases() -> Vec<Base> {
    let [xi_v, epsilon] = TOWER_SUPPORT;
    let support = |eta: f64| Base::Viscoelastic { eta, xi_v, epsilon };
    let rigid = Base::Rigid { epsilon, restitution_factor: 1.0 };
    TOWER_ETA.map(support).into_iter().chain([rigid]).chain(PAD_ETA.map(support)).collect()
}

/// The ground motions in the order of the figure: that of the paper's peak ground accelerations, without vertical motion.
pub fn tower_sources(sources: &[Source]) -> Vec<Source> {
    let mut sources: Vec<Source> = sources.iter().map(Source::horizontal_only).collect();
    sources.sort_by(|a, b| a.pga.total_cmp(&b.pga));
    sources
}

/// The run of the tower on a foundation under a ground motion.
pub fn tower_run(base: Base, source: &Source) -> Result<Run, BlockError> {
    let block = block(TOWER_ALPHA, TOWER_P, base)?;
    let Source { ground, pulse, .. } = source;
    Ok(Run {
        block,
        settings: Settings::default(),
        initial: Initial::default(),
        pulse: *pulse,
        ground: ground.clone(),
        duration: None,
        output_step: f64::INFINITY,
    })
}

/// How many runs the figure has.
pub fn tasks(sources: &[Source]) -> u64 {
    (sources.len() * tower_bases().len()) as u64
}

/// Makes the figure.
pub fn figure(caption: &str, sources: &[Source], work: &mut Work) -> Result<Figure, FigureError> {
    let (sources, bases) = (tower_sources(sources), tower_bases());
    let outcomes = work.make(tasks(&sources), |task| -> Result<Outcome, BlockError> {
        let run = tower_run(bases[task as usize % bases.len()], &sources[task as usize / bases.len()])?;
        Ok(run.outcome())
    });
    let outcomes = outcomes.into_iter().collect::<Result<Vec<_>, _>>()?;
    let lines: Vec<String> = sources.iter().map(|source| format!("motion {}: {}", source.name, source.label)).collect();
    let columns: Vec<&str> = ["motion", "foundation"].into_iter().chain(Outcome::COLUMNS).collect();
    let mut table = Table::new(14, caption, &lines, &columns)?;
    for (task, outcome) in outcomes.iter().enumerate() {
        let place = [sources[task / bases.len()].name.to_string(), bases[task % bases.len()].to_string()];
        table.push(place.into_iter().chain(outcome.fields(TOWER_ALPHA)))?;
    }
    let mut samples: Vec<_> =
        (0..TOWER_ETA.len()).map(|bar| (Sample::Bar(GREYS[bar]), format!("η = {}", short(TOWER_ETA[bar])))).collect();
    samples.push((Sample::Curve(Look::DASH_DOTTED), "rigid base".into()));
    let groups: Vec<&[Outcome]> = outcomes.chunks(bases.len()).collect();
    let svg = page(14, caption, &samples, 12_200, |root, body| draw(root, body, &sources, &groups))?;
    let failed = outcomes.iter().filter(|outcome| outcome.end == End::Failed).count() as u64;
    Ok(Figure { number: 14, svg, table: table.finish()?, failed })
}

/// Fillings of the bars.
const GREYS: [u8; TOWER_ETA.len()] = [255, 190, 90];

/// Draws a group of bars for each ground motion; its outcomes are in the order of [`tower_bases`].
fn draw(root: &Area, area: &Area, sources: &[Source], groups: &[&[Outcome]]) -> Drawn {
    const LINE: i32 = 500;
    let (body, under) = area.split_vertically(area.dim_in_pixel().1 - (LINE as u32) * (sources.len() as u32 + 2));
    let standing = groups.iter().flat_map(|group| group.iter()).filter(|outcome| outcome.end == End::Completed);
    let peaks = standing.map(|outcome| outcome.peaks.theta / TOWER_ALPHA);
    let highest = 1.12 * peaks.fold(1e-9, f64::max);
    let mut chart = ChartBuilder::on(&body)
        .margin_right(800)
        .margin_left(240)
        .margin_top(100)
        .set_label_area_size(LabelAreaPosition::Left, 1560)
        .build_cartesian_2d(0.0..sources.len() as f64, 0.0..highest)?;
    chart
        .configure_mesh()
        .disable_x_mesh()
        .disable_x_axis()
        .light_line_style(TRANSPARENT)
        .bold_line_style(ShapeStyle::from(GRID).stroke_width(30))
        .axis_style(ShapeStyle::from(INK).stroke_width(30))
        .label_style(text(0.9 * TEXT))
        .axis_desc_style(text(TEXT))
        .y_desc("peak |θ|/α")
        .y_labels(8)
        .set_all_tick_mark_size(50)
        .y_label_formatter(&|y| tick(*y, &(0.0..highest)))
        .draw()?;
    let centred = |size: f64, vertical| text(size).pos(Pos::new(HPos::Center, vertical));
    let (left, top) = under.get_base_pixel();
    for (i, (source, group)) in sources.iter().zip(groups).enumerate() {
        let (bars, others) = group.split_at(TOWER_ETA.len());
        for (bar, outcome) in bars.iter().enumerate() {
            let from = i as f64 + 0.17 + 0.22 * bar as f64;
            let (middle, value) = (from + 0.11, outcome.peaks.theta / TOWER_ALPHA);
            match outcome.end {
                End::Completed => {
                    let corners = [(from, 0.0), (from + 0.22, value)].map(|corner| chart.backend_coord(&corner));
                    let grey = RGBColor(GREYS[bar], GREYS[bar], GREYS[bar]);
                    root.draw(&Rectangle::new(corners, grey.filled()))?;
                    outline(root, corners, 40)?;
                    // At the foot of the bar, where no line is in the way; white on a dark one.
                    let (x, y) = chart.backend_coord(&(middle, 0.0));
                    let ink = if GREYS[bar] < 128 { WHITE } else { INK };
                    let style = centred(0.8 * TEXT, VPos::Bottom).color(&ink);
                    root.draw_text(&format!("{value:.3}"), &style, (x, y - 160))?;
                }
                // No peak rotation: the word stands where the bar would.
                End::Overturned | End::Separated | End::Undecided | End::Failed => {
                    let (x, y) = chart.backend_coord(&(middle, 0.0));
                    let upright = text(TEXT).transform(FontTransform::Rotate270);
                    root.draw_text(outcome.end.word(), &upright, (x - 200, y - 200))?;
                }
            }
        }
        if let Some(rigid) = others.first().filter(|outcome| outcome.end == End::Completed) {
            let value = rigid.peaks.theta / TOWER_ALPHA;
            let ends = [i as f64 + 0.1, i as f64 + 0.9].map(|x| chart.backend_coord(&(x, value)));
            Look::DASH_DOTTED.draw(root, &ends)?;
            let beside = text(0.8 * TEXT).pos(Pos::new(HPos::Left, VPos::Center));
            root.draw_text(&format!("{value:.3}"), &beside, (ends[1].0 + 60, ends[1].1))?;
        }
        let letter = (b'a' + i as u8) as char;
        let (x, _) = chart.backend_coord(&(i as f64 + 0.5, 0.0));
        let station = format!("({letter}) PGA {:.2} g", source.pga);
        root.draw_text(&station, &centred(TEXT, VPos::Top), (x, top + 140))?;
        let line = format!("({letter}) {}", source.label);
        root.draw_text(&formula(&line), &text(TEXT), (left + 1800, top + LINE * (i as i32 + 2) - 200))?;
    }
    Ok(())
}
