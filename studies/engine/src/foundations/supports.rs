//! Rubber pads, or a footing on soil → stiffness and damping of the supports.

use std::f64::consts::PI;

/// One of the two supports of a block.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Support {
    /// Stiffness K (N/m): half the vertical stiffness of the foundation.
    pub stiffness: f64,
    /// Damping C (N.s/m): half the vertical damping of the foundation, if the source states it.
    pub damping: Option<f64>,
    /// Support stiffness that would give the rocking stiffness of the foundation (N/m), if known.
    pub rocking_stiffness: Option<f64>,
}

/// A circular pad of rubber between rigid plates, one under each corner.
#[allow(rustdoc::broken_intra_doc_links, reason = "units in brackets, for the help of options")]
#[derive(Clone, Copy, Debug, PartialEq)]
#[cfg_attr(feature = "clap", derive(clap::Args))]
pub struct Pad {
    /// Diameter d of the pad [m]
    #[cfg_attr(feature = "clap", arg(long, value_name = "M"))]
    pub diameter: f64,
    /// Shape factor S: loaded area over the area free to bulge; d/(4 t) for a layer of thickness t
    #[cfg_attr(feature = "clap", arg(long, value_name = "S"))]
    pub shape_factor: f64,
    /// Shear modulus G of the rubber [Pa]
    #[cfg_attr(feature = "clap", arg(long, value_name = "PA"))]
    pub shear_modulus: f64,
    /// Bulk modulus of the rubber; by default it is incompressible, as in the paper [Pa]
    #[cfg_attr(feature = "clap", arg(long, value_name = "PA"))]
    pub bulk_modulus: Option<f64>,
}

/// A rigid rectangular footing on the surface of a homogeneous half-space of soil.
#[allow(rustdoc::broken_intra_doc_links, reason = "units in brackets, for the help of options")]
#[derive(Clone, Copy, Debug, PartialEq)]
#[cfg_attr(feature = "clap", derive(clap::Args))]
pub struct Soil {
    /// Width of the footing in the plane of rocking [m]
    #[cfg_attr(feature = "clap", arg(long, value_name = "M"))]
    pub width: f64,
    /// Length of the footing across that plane [m]
    #[cfg_attr(feature = "clap", arg(long, value_name = "M"))]
    pub length: f64,
    /// Velocity of shear waves in the soil, at the strain of the earthquake [m/s]
    #[cfg_attr(feature = "clap", arg(long, value_name = "M/S"))]
    pub shear_wave_velocity: f64,
    /// Density of the soil [kg/m3]
    #[cfg_attr(feature = "clap", arg(long, value_name = "KG/M3"))]
    pub density: f64,
    /// Poisson's ratio of the soil
    #[cfg_attr(feature = "clap", arg(long, value_name = "NU"))]
    pub poisson: f64,
}

/// An invalid size or material of a support.
#[derive(Clone, Debug, PartialEq, thiserror::Error)]
#[error("{name} = {value} is not valid; expected {expected}")]
pub struct SupportError {
    /// Name of the parameter.
    pub name: &'static str,
    /// Its value.
    pub value: f64,
    /// The valid values.
    pub expected: &'static str,
}

fn check(name: &'static str, value: f64, fits: bool, expected: &'static str) -> Result<(), SupportError> {
    if fits && value.is_finite() { Ok(()) } else { Err(SupportError { name, value, expected }) }
}

fn check_positive(values: &[(&'static str, f64)]) -> Result<(), SupportError> {
    values.iter().try_for_each(|&(name, value)| check(name, value, value > 0.0, "a number > 0"))
}

impl Pad {
    /// Returns the support: `K = 6 π d G S³`, Palmeri and Makris (2008), eq. (36).
    ///
    /// A pad of one layer has the modulus `E = 6 G S²`, the area `π d²/4` and the thickness `d/(4 S)`. With a bulk modulus B,
    /// `1/E = 1/(6 G S²) + 1/B` after Gent and Lindley (1959).
    ///
    /// # Errors
    /// The first invalid size or modulus.
    pub fn support(&self) -> Result<Support, SupportError> {
        let Pad { diameter, shape_factor, shear_modulus, bulk_modulus } = *self;
        check_positive(&[("diameter", diameter), ("shape_factor", shape_factor), ("shear_modulus", shear_modulus)])?;
        bulk_modulus.map_or(Ok(()), |bulk| check_positive(&[("bulk_modulus", bulk)]))?;
        let incompressible = 6.0 * PI * diameter * shear_modulus * shape_factor * shape_factor * shape_factor;
        let modulus = 6.0 * shear_modulus * shape_factor * shape_factor;
        let stiffness = incompressible / bulk_modulus.map_or(1.0, |bulk| 1.0 + modulus / bulk);
        Ok(Support { stiffness, damping: None, rocking_stiffness: Some(stiffness) })
    }
}

impl Soil {
    /// Returns the support by Pais and Kausel (1988): static stiffnesses and radiation damping.
    ///
    /// With half sides `L ≥ B` and `G = ρ V_s²`: vertical `K_z = G B/(1 − ν) [3.1 (L/B)^0.75 + 1.6]` and
    /// `C_z = 4 ψ ρ V_s B L`; rocking about the longer side `G B³/(1 − ν) [3.2 L/B + 0.8]` and about the shorter one
    /// `G B³/(1 − ν) [3.73 (L/B)^2.4 + 0.27]`; `ψ = √(2 (1 − ν)/(1 − 2 ν))`, at most 2.5.
    ///
    /// # Errors
    /// The first invalid size, velocity, density or ratio.
    pub fn support(&self) -> Result<Support, SupportError> {
        let Soil { width, length, density, shear_wave_velocity, poisson } = *self;
        check_positive(&[("width", width), ("length", length), ("density", density)])?;
        check_positive(&[("shear_wave_velocity", shear_wave_velocity)])?;
        check("poisson", poisson, (0.0..0.5).contains(&poisson), "a ratio from 0 to less than 0.5")?;
        let (half_width, half_length) = (0.5 * width, 0.5 * length);
        let (short, long) = (half_width.min(half_length), half_width.max(half_length));
        let ratio = long / short;
        let modulus = density * shear_wave_velocity * shear_wave_velocity / (1.0 - poisson);
        let vertical = modulus * short * (3.1 * libm::pow(ratio, 0.75) + 1.6);
        let about_long_side = 3.2 * ratio + 0.8;
        let about_short_side = 3.73 * libm::pow(ratio, 2.4) + 0.27;
        let shape = if width <= length { about_long_side } else { about_short_side };
        let rocking = modulus * short * short * short * shape;
        let wave_ratio = (2.0 * (1.0 - poisson) / (1.0 - 2.0 * poisson)).sqrt().min(2.5);
        let damping = 4.0 * wave_ratio * density * shear_wave_velocity * short * long;
        Ok(Support {
            stiffness: 0.5 * vertical,
            damping: Some(0.5 * damping),
            rocking_stiffness: Some(rocking / (2.0 * half_width * half_width)),
        })
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    const SOIL: Soil = Soil { width: 2.0, length: 2.0, density: 1800.0, shear_wave_velocity: 200.0, poisson: 0.3 };

    /// The paper's pads of the South Rangitikei Viaduct have the values of (36). They have G = 1 MPa, d = 2 m,
    /// M = 700 000 kg and p = 0.38 rad/s, with S = 5 and 10.
    #[test]
    fn pads_are_those_of_the_paper() {
        for (shape_factor, stiffness, omega_v, eta) in [(5.0, 4710e6, 116.0, 305.0), (10.0, 37_700e6, 328.0, 863.0)] {
            let pad = Pad { diameter: 2.0, shape_factor, shear_modulus: 1e6, bulk_modulus: None };
            let Support { stiffness: found, damping, .. } = pad.support().unwrap();
            let close = |a: f64, b: f64| (a / b - 1.0).abs() < 2e-3;
            let frequency = (2.0 * found / 700_000.0).sqrt();
            assert!(close(found, stiffness) && close(frequency, omega_v) && close(frequency / 0.38, eta), "{found}");
            assert_eq!(damping, None);
        }
    }

    /// A very compressible layer is a column of that bulk modulus. A stiff one is the paper's.
    #[test]
    fn compressible_pads_lie_between_both_limits() {
        let of = |bulk_modulus| {
            let pad = Pad { diameter: 0.5, shape_factor: 12.0, shear_modulus: 0.9e6, bulk_modulus };
            pad.support().unwrap().stiffness
        };
        let column = |bulk: f64| bulk * 0.25 * PI * 0.25 / (0.5 / 48.0);
        assert!((of(Some(1e3)) / column(1e3) - 1.0).abs() < 1e-5);
        assert!((of(Some(1e18)) / of(None) - 1.0).abs() < 1e-9);
        let springs = 1.0 / (1.0 / of(None) + 1.0 / column(2e9));
        assert!((of(Some(2e9)) / springs - 1.0).abs() < 1e-12);
    }

    /// A square footing is nearly a disc of the same area, or moment of inertia. The stiffnesses of a disc on a half-space are exact:
    /// 4 G r/(1 − ν) and 8 G r³/(3 (1 − ν)).
    #[test]
    fn square_footings_are_nearly_discs() {
        let Support { stiffness, rocking_stiffness, .. } = SOIL.support().unwrap();
        let shear_modulus = SOIL.density * SOIL.shear_wave_velocity * SOIL.shear_wave_velocity;
        let modulus = shear_modulus / (1.0 - SOIL.poisson);
        let disc = 4.0 * modulus * (4.0 / PI).sqrt();
        assert!((2.0 * stiffness / disc - 1.0).abs() < 0.05, "{}", 2.0 * stiffness / disc);
        let radius = (16.0 / (3.0 * PI)).powf(0.25);
        let disc = 8.0 / 3.0 * modulus * radius.powi(3);
        let rocking = 2.0 * rocking_stiffness.unwrap();
        assert!((rocking / disc - 1.0).abs() < 0.02, "{}", rocking / disc);
    }

    /// The dashpots absorb plane compression waves under the whole footing: ρ V_p A.
    #[test]
    fn radiation_is_that_of_plane_waves() {
        let soil = Soil { width: 3.0, length: 1.2, ..SOIL };
        let compression = soil.shear_wave_velocity * (2.0 * 0.7 / 0.4_f64).sqrt();
        let expected = soil.density * compression * 3.0 * 1.2;
        assert!((2.0 * soil.support().unwrap().damping.unwrap() / expected - 1.0).abs() < 1e-12);
    }

    /// A square footing has the same rocking stiffness about both axes. One twice as long is stiffer, but not twice as stiff, as its halves share the soil.
    #[test]
    fn both_axes_agree_for_a_square() {
        let of = |width: f64, length: f64| Soil { width, length, ..SOIL }.support().unwrap();
        let (one, other) = (of(2.0, 2.0 + 1e-9), of(2.0, 2.0 - 1e-9));
        assert!((one.rocking_stiffness.unwrap() / other.rocking_stiffness.unwrap() - 1.0).abs() < 1e-6);
        let ratio = of(2.0, 4.0).stiffness / one.stiffness;
        assert!(ratio > 1.0 && ratio < 2.0 && of(4.0, 2.0).stiffness == of(2.0, 4.0).stiffness, "{ratio}");
        assert!(of(4.0, 2.0).rocking_stiffness > one.rocking_stiffness);
    }

    #[test]
    fn errors_name_the_parameter() {
        let message = |soil: Soil| soil.support().unwrap_err().to_string();
        assert_eq!(
            message(Soil { poisson: 0.5, ..SOIL }),
            "poisson = 0.5 is not valid; expected a ratio from 0 to less than 0.5"
        );
        assert_eq!(message(Soil { width: -1.0, ..SOIL }), "width = -1 is not valid; expected a number > 0");
        let pad = Pad { diameter: 1.0, shape_factor: f64::INFINITY, shear_modulus: 1e6, bulk_modulus: None };
        assert_eq!(pad.support().unwrap_err().name, "shape_factor");
        let pad = Pad { shape_factor: 5.0, bulk_modulus: Some(0.0), ..pad };
        assert_eq!(pad.support().unwrap_err().name, "bulk_modulus");
    }
}
