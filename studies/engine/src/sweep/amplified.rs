//! Factors on records → doubts about strong ones.

use std::collections::BTreeMap;

use crate::output::table::{Series, Table};
use crate::sweep::Sweep;
use crate::sweep::ground_motion::{GroundMotion, joined};
use crate::sweep::strength::Strengths;

/// Largest usual factor on a record; beyond it, noise of the instrument becomes ground motion.
const LARGEST_SCALE: f64 = 20.0;

/// Doubts a factor on a record, if it is greater than usual; `is` is the verb.
fn strong_scale(name: &str, is: &str, largest: f64) -> Option<String> {
    (largest > LARGEST_SCALE).then(|| {
        let largest = if largest < 1e6 { format!("{largest:.1}") } else { format!("{largest:.1e}") };
        format!(
            "{name} {is} scaled by up to {largest}; expected at most {LARGEST_SCALE}, beyond which noise is amplified"
        )
    })
}

impl Sweep {
    /// Names the records that a strength scales by more than usual, or may. The block is that in the middle of the study. The levels of a hunt
    /// follow from its runs: [`Sweep::hunted_scales`].
    pub(super) fn amplified(&self) -> Vec<String> {
        let middle: Vec<f64> = self.parameters.iter().map(|swept| swept.values.at(0.5)).collect();
        let Ok(scales) = self.scales(&self.row_values(&middle)) else { return Vec::new() };
        let of = |motion: &GroundMotion| {
            let (largest, is) = match &self.strengths {
                Strengths::Scales(_) | Strengths::Levels(..) => {
                    let scale = |strength| self.strengths.scale(strength, motion, scales).abs();
                    ((0..self.strengths.count()).map(scale).fold(0.0, f64::max), "is")
                }
                Strengths::Hunt(..) => return None,
                Strengths::Least(measure, scan) => (motion.scale_to(*measure, scan.to, scales), "may be"),
            };
            strong_scale(&motion.name(), is, largest).filter(|_| motion.has_record())
        };
        self.motions.iter().filter_map(of).collect()
    }

    /// Begins to follow the factors on the records of a hunt, which are known after its runs. `None` for strengths that the study names:
    /// reading it has doubted them.
    pub fn hunted_scales(&self) -> Option<GreatestScales> {
        matches!(self.strengths, Strengths::Hunt(..)).then(GreatestScales::default)
    }
}

/// The greatest factor on each record in rows of a sweep, by the names of its files.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct GreatestScales(pub BTreeMap<String, f64>);

impl GreatestScales {
    /// Takes rows with the columns of a sweep.
    pub fn take(&mut self, rows: &Table) {
        let word = |column: Option<&Series>, row| column.and_then(|column| column.word(row).map(String::from));
        let records = ["record", "record_y", "vertical"].map(|name| rows.column(name));
        let Some(scale) = rows.column("scale") else { return };
        for row in 0..rows.rows() {
            let names = records.map(|column| word(column, row).unwrap_or_default());
            let known = self.0.entry(joined(names.each_ref().map(String::as_str))).or_default();
            *known = known.max(scale.number(row).unwrap_or_default().abs());
        }
    }

    /// Takes the factors of other rows.
    pub fn append(&mut self, others: GreatestScales) {
        for (name, scale) in others.0 {
            let known = self.0.entry(name).or_default();
            *known = known.max(scale);
        }
    }

    /// Names the records that are scaled by more than usual.
    pub fn doubts(&self) -> Vec<String> {
        self.0.iter().filter_map(|(name, scale)| strong_scale(name, "is", *scale)).collect()
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::output::table::TableColumn;

    /// A record with a vertical one is another motion, and rows in several batches count together.
    #[test]
    fn the_greatest_factor_of_each_record_is_doubted() {
        let columns = [
            TableColumn::text("record", |(record, ..): &(&str, &str, f64)| record.to_string()),
            TableColumn::text("vertical", |(_, vertical, _): &(&str, &str, f64)| vertical.to_string()),
            TableColumn::real("scale", "1", |(.., scale): &(&str, &str, f64)| *scale),
        ];
        let mut found = GreatestScales::default();
        for rows in [[("a", "", 3.0), ("b", "v", -25.0)], [("a", "", 20.0), ("b", "v", 4.0)]] {
            found.take(&Table::of(&columns, &rows));
        }
        let one = "b + v is scaled by up to 25.0; expected at most 20, beyond which noise is amplified";
        assert_eq!(found.doubts(), [one]);
        found.append(GreatestScales([("a".to_string(), 21.0)].into()));
        assert_eq!(found.doubts().len(), 2);
    }
}
