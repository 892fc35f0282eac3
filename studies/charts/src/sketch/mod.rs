//! A block, its ties → a sketch with dimensions, by which a user can check the input.
//!
//! | module | in → out |
//! | --- | --- |
//! | `symbols` | points → springs, dashpots, ground, anchors, dimensions |
//! | `layout` | block and ties → a scale and the positions of the dimensions |
//! | `in_space` | a block in space → its sketch in axonometry |

mod in_space;
mod layout;
mod symbols;

use plotters::style::text_anchor::{HPos, VPos};

use crate::canvas::{Area, Drawn, PIXEL, TEXT, anchored, grey};
use crate::formula::{formula, marked_width};
use crate::history::link_names;
use crate::labels;
use crate::numerals::significant;
use crate::page::{MARGIN, page_of, wrapped};
use crate::picture::PictureError;
pub use in_space::SketchInSpace;
use layout::{Layout, RECESS, SUPPORT};
use rocking_block::block::restraints::Tie;
use rocking_block::block::restraints::tie::{LinkNumber, Quantity};
use rocking_block::block::{Block, Body, Corner, Foundation, Supports};
use symbols::{
    OUTLINE, angle, axis, centre_of_mass, extension, fill_polygon, hatched, horizontal_dimension, leader, stroke,
    support, tie, vertical_dimension, write,
};

/// Greatest width of the column of values.
const COLUMN: f64 = 7200.0;
/// Distance of the lines of that column, and of its paragraphs.
const LINES: [f64; 2] = [520.0, 760.0];

/// The block to be drawn.
#[derive(Clone, Debug, PartialEq)]
pub struct Sketch {
    /// The block, with the width of its base and the height of its centre of mass.
    pub block: Block,
    /// Height of the body (m), if known. The sides of a body of unknown height fade out above its centre of mass.
    pub height: Option<f64>,
}

impl Sketch {
    /// Returns the sketch of a block twice as high as its centre of mass.
    pub fn of(block: &Block) -> Sketch {
        Sketch { block: *block, height: Some(2.0 * block.h) }
    }

    /// Draws the sketch as SVG.
    ///
    /// # Errors
    /// [`PictureError::Drawing`].
    pub fn svg(&self) -> Result<String, PictureError> {
        let base = match self.block.foundation {
            Foundation::Viscoelastic => "viscoelastic supports",
            Foundation::Rigid => "a rigid base",
        };
        let height = self.height.map(|height| format!(", {} m high", significant(height, 4))).unwrap_or_default();
        let title = format!("Block {} m wide{height}, on {base}", significant(2.0 * self.block.b, 4));
        let layout = Layout::new(self);
        beside_values(&title, self.paragraphs(), layout.ends, |area| self.draw(area, &layout))
    }

    fn draw(&self, area: &Area, layout: &Layout) -> Drawn {
        self.draw_body(area, layout)?;
        self.draw_dimensions(area, layout)?;
        self.draw_foundation(area, layout)?;
        for ((name, link), drawn) in link_names(&self.block).iter().zip(self.block.ties()).zip(&layout.ties) {
            // A tie by its number, as in `1`, a damper as in `D1`.
            let label = name.replace("tie ", "").replace("damper ", "D");
            tie(area, [drawn.block, drawn.end], drawn.kind, link.kind, &label, layout.centre)?;
        }
        self.draw_angles(area, layout)?;
        centre_of_mass(area, layout.centre)
    }

    fn draw_body(&self, area: &Area, layout: &Layout) -> Drawn {
        let Layout { left, right, top, base, centre, .. } = *layout;
        fill_polygon(area, &[(left, base), (left, top), (right, top), (right, base)], grey(238))?;
        if self.height.is_some() {
            return stroke(area, &[(left, base), (left, top), (right, top), (right, base), (left, base)], OUTLINE);
        }
        stroke(area, &[(left, centre.1), (left, base), (right, base), (right, centre.1)], OUTLINE)?;
        axis(area, &[(left, centre.1), (left, top)])?;
        axis(area, &[(right, centre.1), (right, top)])
    }

    fn draw_foundation(&self, area: &Area, layout: &Layout) -> Drawn {
        let Layout { left, right, base, edges, .. } = *layout;
        match self.block.foundation {
            Foundation::Rigid => hatched(area, (edges[0], base), (edges[1], base), OUTLINE),
            Foundation::Viscoelastic => {
                let ground = base + SUPPORT;
                for (corner, middle) in [left, right].into_iter().zip(layout.supports) {
                    support(area, middle, corner, [base, ground])?;
                }
                write(area, "K", (layout.supports[0] - 560.0, base + 0.55 * SUPPORT), HPos::Right, VPos::Center)?;
                write(area, "C", (layout.supports[1] + 560.0, base + 0.55 * SUPPORT), HPos::Left, VPos::Center)?;
                if self.block.ties().is_empty() {
                    return hatched(area, (edges[0], ground), (edges[1], ground), OUTLINE);
                }
                // The ground around the block is at the height of its base, from which anchors are measured.
                let [from, to] = [layout.supports[0] - RECESS, layout.supports[1] + RECESS];
                let corners =
                    [(edges[0], base), (from, base), (from, ground), (to, ground), (to, base), (edges[1], base)];
                corners.windows(2).try_for_each(|side| hatched(area, side[0], side[1], OUTLINE))
            }
        }
    }

    /// Draws the lines from the corners to the centre of mass. Their angles are from the vertical.
    fn draw_angles(&self, area: &Area, layout: &Layout) -> Drawn {
        let Layout { left, right, base, centre, label_edges, .. } = *layout;
        const UP: f64 = std::f64::consts::FRAC_PI_2;
        for corner in [left, right] {
            axis(area, &[(corner, base), centre])?;
        }
        let is_symmetric = self.block.eccentricity == 0.0;
        let [alpha_l, alpha_r] = Corner::each(|corner| self.block.alpha_of(corner));
        let reach = |corner: f64| (centre.0 - corner).hypot(centre.1 - base);
        let at = |corner: f64, fraction: f64, turned: f64| {
            let (sin, cos) = libm::sincos(UP - turned);
            (corner + fraction * reach(corner) * cos, base - fraction * reach(corner) * sin)
        };
        let label = |value: f64, name: &str| format!("{name} = {}°", significant(value.to_degrees(), 4));
        let [left_edge, right_edge] = label_edges;
        // The arc of a squat block stays below its top.
        let fraction = |corner: f64| (0.8 * (base - layout.top) / reach(corner)).min(0.5);
        // A sloping leader keeps the arc of a small angle visible.
        const LOWER: f64 = 330.0;
        let name = if is_symmetric { "α" } else { "α_R" };
        angle(area, (right, base), fraction(right) * reach(right), UP, UP + alpha_r)?;
        let middle = at(right, fraction(right), -0.5 * alpha_r);
        // The line of the dimension h is above it.
        let height = (middle.1 + LOWER).max(centre.1 + 400.0);
        leader(area, (right_edge - 80.0, height), middle)?;
        write(area, &label(alpha_r, name), (right_edge, height), HPos::Left, VPos::Center)?;
        if is_symmetric {
            let middle = at(left, 0.72, alpha_l);
            leader(area, (left_edge + 80.0, middle.1), middle)?;
            let radius = format!("R0 = {} m", significant(self.block.r0, 4));
            return write(area, &radius, (left_edge, middle.1), HPos::Right, VPos::Center);
        }
        angle(area, (left, base), fraction(left) * reach(left), UP - alpha_l, UP)?;
        let middle = at(left, fraction(left), 0.5 * alpha_l);
        let height = middle.1 + LOWER;
        leader(area, (left_edge + 80.0, height), middle)?;
        write(area, &label(alpha_l, "α_L"), (left_edge, height), HPos::Right, VPos::Center)
    }

    fn draw_dimensions(&self, area: &Area, layout: &Layout) -> Drawn {
        let Layout { left, right, top, base, centre, sides, row, .. } = *layout;
        let metres = |name: &str, value: f64| format!("{name} = {} m", significant(value, 4));
        let Body { b, h, .. } = self.block.body;
        const GAP: f64 = 120.0;
        const PAST: f64 = 150.0;
        if let Some(height) = self.height {
            extension(area, (left - GAP, top), (sides[0] - PAST, top))?;
            extension(area, (left - GAP, base), (sides[0] - PAST, base))?;
            let label = if height == 2.0 * h { metres("2h", height) } else { metres("height", height) };
            vertical_dimension(area, sides[0], [top, base], &label, HPos::Left)?;
        }
        extension(area, (centre.0 + 2.0 * GAP, centre.1), (sides[1] + PAST, centre.1))?;
        extension(area, (right + GAP, base), (sides[1] + PAST, base))?;
        vertical_dimension(area, sides[1], [centre.1, base], &metres("h", h), HPos::Right)?;
        for corner in [left, right] {
            extension(area, (corner, layout.below), (corner, row + PAST))?;
        }
        horizontal_dimension(area, [left, right], row, &metres("2b", 2.0 * b))?;
        if self.block.eccentricity == 0.0 {
            return Ok(());
        }
        let middle = 0.5 * (left + right);
        let above = top - layout::ABOVE;
        axis(area, &[(middle, base), (middle, above - PAST)])?;
        axis(area, &[(centre.0, base), (centre.0, above - PAST)])?;
        let ends = [middle.min(centre.0), middle.max(centre.0)];
        horizontal_dimension(area, ends, above, &metres("e_x", self.block.eccentricity))
    }

    /// Returns the values in words: body, foundation, ties.
    fn paragraphs(&self) -> Vec<Vec<String>> {
        let Block { gamma, epsilon, stiffness, damping, body: Body { p, r0, mass, .. }, .. } = self.block;
        let short = |value: f64| significant(value, 4);
        let angle = |name: &str, value: f64| format!("{name} = {} rad = {}°", short(value), short(value.to_degrees()));
        let [alpha_l, alpha_r] = Corner::each(|corner| self.block.alpha_of(corner));
        let is_symmetric = self.block.eccentricity == 0.0;
        let mut body = match is_symmetric {
            true => vec![angle("α", alpha_r)],
            false => vec![angle("α_L", alpha_l), angle("α_R", alpha_r)],
        };
        body.push(format!("R0 = {} m", short(r0)));
        body.push(format!("p = {} rad/s, γ = {}", short(p), short(gamma)));
        body.push(format!("M = {} kg", short(mass)));
        let mut base = match self.block.ratios() {
            Supports::Viscoelastic(ratios) => vec![
                "each support:".into(),
                format!("K = {}, C = {}", engineering(stiffness, "N/m"), engineering(damping, "N s/m")),
                labels::supports(ratios, epsilon, short),
            ],
            Supports::Rigid { .. } if is_symmetric => {
                vec![format!("rigid base, e = {}", short(self.block.restitution()))]
            }
            Supports::Rigid { .. } => {
                let [left, right] = Corner::each(|corner| short(self.block.restitution_of(corner)));
                vec![format!("rigid base, e_L = {left}, e_R = {right}")]
            }
        };
        if self.block.friction > 0.0 {
            base.push(format!("friction μ = {}", short(self.block.friction)));
        }
        let ties = link_names(&self.block).into_iter().zip(self.block.ties()).map(|(name, tie)| tie_values(tie, &name));
        [body, base].into_iter().chain(ties).collect()
    }
}

/// Draws a sketch that ends at these coordinates, with paragraphs of values at its right.
///
/// # Errors
/// [`PictureError::Drawing`].
fn beside_values(
    title: &str,
    paragraphs: Vec<Vec<String>>,
    [left, lower]: [f64; 2],
    draw: impl FnOnce(&Area) -> Drawn,
) -> Result<String, PictureError> {
    let mut y = 700.0;
    let mut lines = Vec::new();
    for paragraph in paragraphs {
        for line in paragraph.iter().flat_map(|line| wrapped(&formula(line), TEXT, COLUMN)) {
            lines.push((line, y));
            y += LINES[0];
        }
        y += LINES[1] - LINES[0];
    }
    let column = lines.iter().map(|(_, y)| *y).fold(0.0, f64::max) + LINES[1];
    let widest = lines.iter().map(|(line, _)| marked_width(line, TEXT)).fold(0.0, f64::max);
    let title = formula(title);
    let width = (left + widest).max(marked_width(&title, 1.15 * TEXT) + f64::from(MARGIN)) + f64::from(MARGIN);
    let size = [width, lower.max(column)].map(|length| (length / f64::from(PIXEL)).ceil() as u32 * PIXEL);
    page_of(size, &[title], &[], |_, body| {
        draw(body)?;
        let style = anchored(TEXT, HPos::Left, VPos::Center);
        lines.iter().try_for_each(|(line, y)| {
            Ok(body.draw_text(&line.replace('\u{A0}', " "), &style, symbols::unit((left, *y)))?)
        })
    })
}

/// Returns the values of a tie in words.
fn tie_values(tie: &Tie, name: &str) -> Vec<String> {
    let point = |[x, z]: [f64; 2]| format!("({},\u{A0}{})", significant(x, 4), significant(z, 4));
    let (mut law, mut last) = (format!("k = {}", engineering(tie.stiffness, "N/m")), String::new());
    let numbers = tie.kind.numbers().zip(tie.named());
    for (LinkNumber { quantity, .. }, (name, value)) in numbers.filter(|(_, (_, value))| *value != 0.0) {
        let word = if name == "yield_force" { "yields at" } else { name };
        let (text, value) = match quantity {
            Quantity::Coordinate | Quantity::Stiffness => continue,
            Quantity::Force | Quantity::Damping => (&mut law, engineering(value, &quantity.unit().replace('.', " "))),
            Quantity::Length => (&mut last, format!("{} m", significant(value, 4))),
            Quantity::Ratio => (&mut last, significant(value, 4)),
        };
        *text += &format!(", {word}\u{A0}{}", value.replace(' ', "\u{A0}"));
    }
    vec![format!("{name}: {} to {} m", point(tie.block), point(tie.ground)), law + &last]
}

/// Formats a value with four digits and a prefix of its unit.
fn engineering(value: f64, unit: &str) -> String {
    let (factor, prefix) = match value.abs() {
        x if x >= 1e9 => (1e9, "G"),
        x if x >= 1e6 => (1e6, "M"),
        x if x >= 1e3 => (1e3, "k"),
        _ => (1.0, ""),
    };
    format!("{} {prefix}{unit}", significant(value / factor, 4))
}

#[cfg(test)]
mod tests;
