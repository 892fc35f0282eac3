//! Blocks and pulses → remarks on numbers beyond reason, mostly slips of units.

use rocking_block::block::{Block, Foundation};
use rocking_block::excitation::{Pulse, PulseShape};

/// Least and greatest width and height of a block (m).
const SIZES: [f64; 2] = [1e-3, 200.0];
/// Greatest vertical damping ratio of supports (1).
const MAX_XI_V: f64 = 50.0;
/// Greatest amplitude of a pulse over gravity (1), that of records in files.
const MAX_AMPLITUDE: f64 = 20.0;

/// Returns the first remark of each kind on blocks. Kinds are supports too soft to keep them upright, sizes, proportions, and
/// damping.
pub fn of_blocks(blocks: impl IntoIterator<Item = Block>) -> Vec<String> {
    first_of_each(blocks, [&Block::soft_supports, &size, &stocky, &damping])
}

/// A kind of remark.
type Kind<'a, T> = &'a dyn Fn(&T) -> Option<String>;

/// Returns the first remark of each kind on some items.
fn first_of_each<T, const N: usize>(items: impl IntoIterator<Item = T>, kinds: [Kind<T>; N]) -> Vec<String> {
    let mut found = [const { None }; N];
    for item in items {
        for (found, kind) in found.iter_mut().zip(kinds).filter(|(found, _)| found.is_none()) {
            *found = kind(&item);
        }
        if found.iter().all(Option::is_some) {
            break;
        }
    }
    found.into_iter().flatten().collect()
}

/// Rounds a number to four significant digits.
pub(crate) fn short(value: f64) -> f64 {
    format!("{value:.3e}").parse().unwrap_or(value)
}

fn size(block: &Block) -> Option<String> {
    let [width, height] = [2.0 * block.b, 2.0 * block.h];
    let [least, greatest] = SIZES;
    let is_plausible = least <= width && width <= greatest && least <= height && height <= greatest;
    (!is_plausible).then(|| {
        format!(
            "the block is {} m wide and {} m high (2h), with p = {} rad/s; expected {least} to {greatest} m",
            short(width),
            short(height),
            short(block.p)
        )
    })
}

fn stocky(block: &Block) -> Option<String> {
    (block.b > block.h).then(|| {
        format!(
            "the block is {} m wide and {} m high (2h), with alpha = {} rad; expected a height above the width: they may be swapped",
            short(2.0 * block.b),
            short(2.0 * block.h),
            short(block.alpha)
        )
    })
}

fn damping(block: &Block) -> Option<String> {
    let (damping, xi_v) = (block.damping, block.xi_v);
    (block.foundation == Foundation::Viscoelastic && xi_v > MAX_XI_V).then(|| {
        format!(
            "the supports have xi_v = {}, C = {damping:.4e} N.s/m; expected xi_v of at most {MAX_XI_V}",
            short(xi_v)
        )
    })
}

/// Returns the first remark of each kind on pulses with their gravity (m/s²). Kinds are amplitudes, and those of [`of_end`].
pub fn of_pulses(pulses: impl IntoIterator<Item = (Pulse, f64)>, has_record: bool) -> Vec<String> {
    let pulses = pulses.into_iter().filter(|(pulse, _)| pulse.shape != PulseShape::None);
    first_of_each(pulses, [&|(pulse, gravity)| amplitude(pulse, *gravity), &|(pulse, _)| of_end(pulse, has_record)])
}

fn amplitude(pulse: &Pulse, gravity: f64) -> Option<String> {
    let amplitude = pulse.amplitude;
    (amplitude.abs() > MAX_AMPLITUDE * gravity).then(|| {
        format!(
            "the amplitude of the pulse, {amplitude} m/s2, is {} g; expected at most {MAX_AMPLITUDE} g",
            short(amplitude / gravity)
        )
    })
}

/// Returns a remark on a pulse that ends before the run starts.
///
/// A run without a record starts at 0; one with a record starts no later than its pulse.
pub fn of_end(pulse: &Pulse, has_record: bool) -> Option<String> {
    let end = pulse.end();
    (!has_record && pulse.shape != PulseShape::None && end <= 0.0).then(|| {
        format!(
            "the pulse ends at {} s, before the run starts at 0 s, and does nothing; expected a later start",
            short(end)
        )
    })
}

#[cfg(test)]
mod tests {
    use super::*;
    use rocking_block::block::{BlockParameters, Body, Common, KelvinVoigt, Outline, Springs, Supports};

    /// A block of 0.6 m × 2.4 m on stiff supports, with other sizes and damping.
    fn block(width: f64, height: f64, damping: f64, foundation: Foundation) -> Block {
        let outline = Outline::Sizes { width, height, inertia: None };
        let supports = Supports::of(foundation, KelvinVoigt::Springs(Springs { stiffness: 1e7, damping }));
        Block::new(&BlockParameters { outline, supports, common: Common::default() }).unwrap()
    }

    #[test]
    fn each_kind_is_said_once() {
        let plain = block(0.6, 2.4, 4e4, Foundation::Viscoelastic);
        assert_eq!(of_blocks([plain]), Vec::<String>::new());
        let in_mm = block(600.0, 2400.0, 4e4, Foundation::Rigid);
        let in_km = block(0.6e-3, 2.4e-3, 4e4, Foundation::Rigid);
        let damped = block(0.6, 2.4, 4e7, Foundation::Viscoelastic);
        let found = of_blocks([plain, in_mm, in_km, damped, damped]);
        assert_eq!(found.len(), 2, "{found:?}");
        assert!(found[0].starts_with("the block is 600 m wide and 2400 m high (2h), with p = "), "{found:?}");
        assert!(found[1].starts_with("the supports have xi_v = 282.8, C = 4.0000e7 N.s/m"), "{found:?}");
        assert_eq!(of_blocks([in_km]).len(), 1);
        let swapped = of_blocks([block(2.4, 0.6, 4e4, Foundation::Rigid)]);
        assert!(
            swapped.len() == 1 && swapped[0].starts_with("the block is 2.4 m wide and 0.6 m high (2h), with alpha")
        );
        assert_eq!(of_blocks([block(1.0, 1.0, 4e4, Foundation::Rigid)]), [""; 0]);
        assert_eq!(
            of_blocks([Block { body: Body { foundation: Foundation::Rigid, ..damped.body }, ..damped }]).len(),
            0
        );
    }

    #[test]
    fn an_amplitude_in_cm_per_second_squared_is_doubted() {
        let pulse = |amplitude: f64| Pulse { shape: PulseShape::OneSine, amplitude, ..Pulse::NONE };
        let of_pulse = |pulse: Pulse| of_pulses([(pulse, 9.81); 2], false);
        assert_eq!(of_pulse(pulse(-196.0)), [""; 0]);
        assert_eq!(of_pulse(Pulse { shape: PulseShape::None, ..pulse(400.0) }), [""; 0]);
        let expected = "the amplitude of the pulse, -400 m/s2, is -40.77 g; expected at most 20 g";
        assert_eq!(of_pulse(pulse(-400.0)), [expected]);
    }

    #[test]
    fn a_pulse_before_the_start_is_doubted_without_a_record() {
        let pulse =
            |start| (Pulse { shape: PulseShape::OneSine, amplitude: 3.0, period: 0.5, start, ..Pulse::NONE }, 9.81);
        let early = of_pulses([pulse(-0.4), pulse(-2.0), pulse(-1.0)], false);
        assert!(
            early.len() == 1 && early[0].starts_with("the pulse ends at -1.5 s, before the run starts"),
            "{early:?}"
        );
        assert_eq!(of_pulses([pulse(-2.0)], true), [""; 0]);
    }
}
