//! Calls in any order, with any values: always a status of the standard, never a panic.

#![no_main]

#[path = "../../../tests/common/fmu.rs"]
#[allow(dead_code, reason = "each target uses its part")]
mod fmu;

use arbitrary::Arbitrary;
use fmu::{Fmu, OK, reference};
use libfuzzer_sys::fuzz_target;

#[derive(Arbitrary, Debug)]
enum Call {
    Setup {
        tolerance: Option<f64>,
        start: f64,
        stop: Option<f64>,
    },
    Enter,
    Exit,
    Terminate,
    Reset,
    Set {
        reference: u8,
        value: f64,
    },
    /// A value of the size that parameters have.
    SetThousandths {
        reference: u8,
        value: i16,
    },
    SetRate {
        reference: u8,
        order: u8,
        value: f64,
    },
    Read {
        references: Vec<u8>,
    },
    Rates {
        reference: u8,
        order: u8,
    },
    Directional {
        of: u8,
        to: u8,
        direction: f64,
    },
    /// From any time on.
    Step {
        time: f64,
        step: f64,
    },
    /// From the present time, over this number of eighths of a radian of the fastest motion.
    Go {
        eighths: u8,
    },
    Save {
        slot: u8,
    },
    Restore {
        slot: u8,
    },
    Free {
        slot: u8,
    },
    Serialize {
        slot: u8,
    },
    Deserialize {
        bytes: Vec<u8>,
    },
}

/// Whether a step may be as long as this: a stiff dashpot or a wild motion is slow to integrate, by nature.
fn is_quick(fmu: &mut Fmu, step: f64) -> bool {
    let mut values = [0.0; 3];
    let references = ["derived.omega_v", "derived.xi_v", "derived.p"].map(reference);
    let known = fmu.reals(&references, &mut values) == OK;
    let [omega_v, xi_v, p] = values;
    let mut period = [0.0];
    let pulse = fmu.reals(&[reference("pulse.period")], &mut period) == OK;
    known && pulse && fmu.is_quick() && (omega_v.max(p) * (1.0 + 2.0 * xi_v) + 6.0 / period[0]) * step < 1e3
}

fuzz_target!(|calls: Vec<Call>| {
    let mut fmu = Fmu::new();
    let mut room = [0.0; 256];
    for call in calls.iter().take(64) {
        let status = match call {
            Call::Setup { tolerance, start, stop } => fmu.setup(*tolerance, *start, *stop),
            Call::Enter => fmu.enter(),
            Call::Exit => fmu.exit(),
            Call::Terminate => fmu.terminate(),
            Call::Reset => fmu.reset(),
            Call::Set { reference, value } => fmu.set((*reference).into(), *value),
            Call::SetThousandths { reference, value } => fmu.set((*reference).into(), f64::from(*value) / 1000.0),
            // As for the motion itself: what lies between is slow.
            Call::SetRate { value, .. } if (1e7..1e30).contains(&value.abs()) => OK,
            Call::SetRate { reference, order, value } => {
                fmu.set_rates(&[(*reference).into()], &[(*order).into()], &[*value])
            }
            Call::Read { references } => {
                let references: Vec<u32> = references.iter().take(256).map(|&r| r.into()).collect();
                fmu.reals(&references, &mut room[..references.len()])
            }
            Call::Rates { reference, order } => fmu.rates(&[(*reference).into()], &[(*order).into()], &mut room[..1]),
            Call::Directional { of, to, direction } => {
                fmu.directional(&[(*of).into()], &[(*to).into()], &[*direction], &mut room[..1])
            }
            Call::Step { time, step } if is_quick(&mut fmu, *step) => fmu.step(*time, *step),
            Call::Step { .. } => OK,
            Call::Go { eighths } => {
                let mut omega = [1.0];
                fmu.reals(&[reference("derived.omega_v")], &mut omega);
                let mut time = 0.0;
                // SAFETY: the instance lives, and there is a place for the time.
                unsafe { rocking_block::fmi::fmi2::exports::fmi2GetRealStatus(fmu.component, 2, &raw mut time) };
                let step = f64::from(*eighths) / (8.0 * omega[0].max(1e-3));
                if is_quick(&mut fmu, step) { fmu.step(time, step) } else { OK }
            }
            Call::Save { slot } => fmu.save((slot % 4).into()),
            Call::Restore { slot } => fmu.restore((slot % 4).into()),
            Call::Free { slot } => fmu.free((slot % 4).into()),
            Call::Serialize { slot } => fmu.serialize((slot % 4).into()).map_or_else(|status| status, |_| OK),
            Call::Deserialize { bytes } => fmu.deserialize(bytes),
        };
        assert!((0..=3).contains(&status), "{call:?}: status {status}");
    }
});
