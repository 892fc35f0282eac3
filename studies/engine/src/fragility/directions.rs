//! The table of a sweep in space, a limit → its outcomes by the direction of the ground motion.

use crate::fragility::table::{SweepTable, SweepTableError};
use crate::run::limit::Limit;
use crate::run::outcome::End;

/// Most azimuths that are shown one by one; more are collected in sectors.
const MOST: usize = 36;
/// Number of sectors of a turn.
const SECTORS: f64 = 12.0;

/// The rows of a direction.
#[derive(Clone, Debug, PartialEq, serde::Serialize)]
pub struct Direction {
    /// The azimuth of the first component (degrees), or the middle of a sector.
    pub azimuth: f64,
    /// Width of the sector (degrees); 0 for a single azimuth.
    pub width: f64,
    /// Number of rows.
    pub rows: usize,
    /// Rows whose outcome is known.
    pub known: usize,
    /// Rows that exceed the limit.
    pub exceeded: f64,
    /// Median of the peak tilt over that of the balance (1), infinite where the median row overturns; `None` without a row with an outcome.
    #[serde(rename = "peak.tilt/alpha")]
    pub median: Option<f64>,
}

impl Direction {
    /// The fraction of the known rows that exceed the limit.
    pub fn fraction(&self) -> Option<f64> {
        (self.known > 0).then(|| self.exceeded / self.known as f64)
    }
}

impl SweepTable {
    /// Returns the rows by their azimuths, in ascending order: each azimuth, or the sectors of many.
    ///
    /// # Errors
    /// A table without azimuths, as that of blocks in the plane, or without the quantity of the limit.
    pub fn directions(&self, limit: Limit) -> Result<Vec<Direction>, SweepTableError> {
        let (cases, ..) = self.cases(limit)?;
        let (azimuths, peaks, ends) = (self.numbers("azimuth")?, self.numbers(self.rotation())?, self.ends()?);
        let mut known = azimuths.iter().flatten().map(|azimuth| azimuth.rem_euclid(360.0)).collect::<Vec<f64>>();
        known.sort_by(f64::total_cmp);
        known.dedup();
        let width = if known.len() > MOST { 360.0 / SECTORS } else { 0.0 };
        let place = |azimuth: f64| match width {
            0.0 => azimuth.rem_euclid(360.0),
            width => width * ((azimuth.rem_euclid(360.0) / width).floor() + 0.5),
        };
        known.iter_mut().for_each(|azimuth| *azimuth = place(*azimuth));
        known.dedup();
        let of = |azimuth: f64| {
            let is_here = |row: usize| azimuths[row].map(place) == Some(azimuth);
            let here = || cases.iter().filter(|case| is_here(case.row));
            let peak = |row: usize| match ends[row] {
                End::Overturned => Some(f64::INFINITY),
                End::Completed => peaks[row],
                End::Separated | End::Undecided | End::Failed => None,
            };
            let mut found: Vec<f64> = (0..self.rows()).filter(|&row| is_here(row)).filter_map(peak).collect();
            found.sort_by(f64::total_cmp);
            Direction {
                azimuth,
                width,
                rows: (0..self.rows()).filter(|&row| is_here(row)).count(),
                known: here().count(),
                exceeded: here().map(|case| case.fraction).sum(),
                // The upper one of two in the middle.
                median: found.get(found.len() / 2).copied(),
            }
        };
        Ok(known.into_iter().map(of).collect())
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn table(rows: &str) -> SweepTable {
        let text = format!("row,azimuth [deg],outcome,peak.tilt/alpha [1]\n{rows}");
        SweepTable::read("t.csv", text.as_bytes()).unwrap()
    }

    #[test]
    fn rows_are_collected_by_their_azimuth() {
        let found = table(
            "0,0,completed,0.2\n1,90,overturned,7\n2,0,completed,0.6\n3,90,undecided,0.3\n4,-270,completed,0.9\n",
        );
        let [first, second] = &found.directions(Limit::Tilt(0.5)).unwrap()[..] else { panic!("two azimuths") };
        assert_eq!((first.azimuth, first.rows, first.known, first.exceeded, first.median), (0.0, 2, 2, 1.0, Some(0.6)));
        // −270° is 90°; an undecided row below the limit has no outcome.
        assert_eq!((second.azimuth, second.rows, second.known, second.fraction()), (90.0, 3, 2, Some(1.0)));
        assert_eq!(second.median, Some(f64::INFINITY));
    }

    #[test]
    fn many_azimuths_are_collected_in_sectors() {
        let rows: String = (0..72).map(|i| format!("{i},{},completed,{}\n", 5.0 * f64::from(i) + 1.0, i % 2)).collect();
        let found = table(&rows).directions(Limit::Tilt(0.5)).unwrap();
        assert_eq!(found.iter().map(|direction| direction.azimuth).collect::<Vec<_>>()[..3], [15.0, 45.0, 75.0]);
        assert!(found.len() == 12 && found.iter().all(|direction| direction.rows == 6 && direction.exceeded == 3.0));
        let message = SweepTable::read("t.csv", "row,outcome,peak.theta/alpha\n0,completed,1\n".as_bytes()).unwrap();
        let message = message.directions(Limit::Overturned).unwrap_err().to_string();
        assert!(message.contains("has no column azimuth"), "{message}");
    }
}
