//! Two horizontal components → one value of a measure.

use rocking_records::Record;

use crate::intensity::{Measure, rot_d};

/// How the values of a measure over the directions of a pair become one.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum OverDirections {
    /// The larger value of both components.
    Larger,
    /// The geometric mean of both components.
    GeometricMean,
    /// The median over all directions, see [`rot_d`].
    RotD50,
    /// The greatest over all directions.
    RotD100,
}

impl OverDirections {
    /// All of them, in the order of the tables.
    pub const ALL: [OverDirections; 4] =
        [OverDirections::Larger, OverDirections::GeometricMean, OverDirections::RotD50, OverDirections::RotD100];

    /// Its word in the names of measures, as in `PGA.RotD50`.
    pub fn word(self) -> &'static str {
        match self {
            OverDirections::Larger => "larger",
            OverDirections::GeometricMean => "geomean",
            OverDirections::RotD50 => "RotD50",
            OverDirections::RotD100 => "RotD100",
        }
    }
}

/// A measure of a component that a pair has over its directions.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum ComponentMeasure {
    /// [`Measure::Pga`].
    Pga,
    /// [`Measure::Pgv`].
    Pgv,
    /// [`Measure::Sa`] at this period (s).
    Sa(f64),
    /// [`Measure::Sv`] at this period (s).
    Sv(f64),
    /// [`Measure::PgaToUplift`].
    PgaToUplift,
    /// [`Measure::PgvToOverturning`].
    PgvToOverturning,
}

impl ComponentMeasure {
    /// The measure of a single component.
    pub fn measure(self) -> Measure {
        match self {
            ComponentMeasure::Pga => Measure::Pga,
            ComponentMeasure::Pgv => Measure::Pgv,
            ComponentMeasure::Sa(period) => Measure::Sa(period),
            ComponentMeasure::Sv(period) => Measure::Sv(period),
            ComponentMeasure::PgaToUplift => Measure::PgaToUplift,
            ComponentMeasure::PgvToOverturning => Measure::PgvToOverturning,
        }
    }

    /// That of a measure; `None` for one that pairs do not have.
    pub(super) fn of(measure: Measure) -> Option<ComponentMeasure> {
        Some(match measure {
            Measure::Pga => ComponentMeasure::Pga,
            Measure::Pgv => ComponentMeasure::Pgv,
            Measure::Sa(period) => ComponentMeasure::Sa(period),
            Measure::Sv(period) => ComponentMeasure::Sv(period),
            Measure::PgaToUplift => ComponentMeasure::PgaToUplift,
            Measure::PgvToOverturning => ComponentMeasure::PgvToOverturning,
            _ => return None,
        })
    }

    /// The name of a measure over directions: that of the measure, with the word behind its symbol.
    pub(super) fn name(self, word: &str) -> String {
        let name = self.measure().to_string();
        let symbol = match self {
            ComponentMeasure::Pga | ComponentMeasure::PgaToUplift => "PGA",
            ComponentMeasure::Pgv | ComponentMeasure::PgvToOverturning => "PGV",
            ComponentMeasure::Sa(_) | ComponentMeasure::Sv(_) => &name,
        };
        name.replacen(symbol, &format!("{symbol}.{word}"), 1)
    }
}

/// Values of a measure of records over the directions of a pair, in the order of [`OverDirections::ALL`]. A missing component is one of
/// zeros.
///
/// `None` where they are not finite, and for measures relative to a block. `gravity` (m/s²) is that of [`Measure::of`].
///
/// # Errors
/// Components with different time steps or starts.
pub fn over_directions(
    measure: ComponentMeasure,
    [x, y]: [&Record; 2],
    gravity: f64,
) -> Result<Option<[f64; 4]>, String> {
    let measure = measure.measure();
    let Some([first, second]) = measure.of(x, gravity).zip(measure.of(y, gravity)).map(<[f64; 2]>::from) else {
        return Ok(None);
    };
    let of_directions = rot_d(measure, [x, y], [50.0, 100.0], gravity)?;
    Ok(of_directions.map(|[median, greatest]| [first.max(second), (first * second).sqrt(), median, greatest]))
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::intensity::{near, record_of};

    /// A motion along a line at 30°: the components are cos 30° and sin 30° of it, and the middle direction is 45° off the line.
    #[test]
    fn a_motion_along_a_line_has_closed_forms() {
        let angle = 30.0_f64.to_radians();
        let along =
            |factor: f64| record_of(&(0..400).map(|i| factor * (0.05 * f64::from(i)).sin()).collect::<Vec<_>>(), 0.01);
        let line = [along(2.0 * angle.cos()), along(2.0 * angle.sin())];
        for measure in
            [ComponentMeasure::Pga, ComponentMeasure::Pgv, ComponentMeasure::Sa(0.4), ComponentMeasure::Sv(0.4)]
        {
            let whole = measure.measure().of(&along(2.0), 9.81).unwrap();
            let found = over_directions(measure, [&line[0], &line[1]], 9.81).unwrap().unwrap();
            let (sin, cos) = angle.sin_cos();
            let expected = [cos, (sin * cos).sqrt(), 0.5_f64.sqrt(), 1.0];
            for (found, expected) in found.into_iter().zip(expected) {
                near(found, expected * whole, 1e-12);
            }
        }
        assert_eq!(over_directions(ComponentMeasure::PgaToUplift, [&line[0], &line[1]], 9.81), Ok(None));
    }
}
