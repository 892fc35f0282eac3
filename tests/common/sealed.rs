//! Serialized states with a valid envelope around arbitrary content.

use rocking_block::fmi::fmi2::types::fmi2Status;
use rocking_block::unit::snapshot::VERSION;
use rocking_block::unit::variables::GUID;

use crate::fmu::{DISCARD, ERROR, Fmu, OK, reference};

const MAGIC: &[u8] = b"rockblk\x1a";

/// Wraps content as postcard does: magic, version, GUID, length and checksum before it.
pub fn seal(content: &[u8]) -> Vec<u8> {
    let mut bytes = MAGIC.to_vec();
    number(&mut bytes, VERSION.into());
    number(&mut bytes, GUID.len() as u64);
    bytes.extend_from_slice(GUID.as_bytes());
    number(&mut bytes, content.len() as u64);
    number(&mut bytes, crc32fast::hash(content).into());
    bytes.extend_from_slice(content);
    bytes
}

/// Writes a number with seven bits per byte, lowest first.
fn number(bytes: &mut Vec<u8>, mut value: u64) {
    while value >= 0x80 {
        bytes.push(value as u8 | 0x80);
        value >>= 7;
    }
    bytes.push(value as u8);
}

/// Returns the content of a serialized state.
pub fn content(bytes: &[u8]) -> &[u8] {
    let start = (0..bytes.len()).find(|&start| seal(&bytes[start..]) == bytes);
    &bytes[start.expect("a serialized state")..]
}

/// Uses an instance with a state of unknown origin. Any status is right; panics and long steps are not.
pub fn go_on(fmu: &mut Fmu) {
    let check = |status: fmi2Status| assert!([OK, 1, DISCARD, ERROR].contains(&status), "status {status}");
    // The legal calls work, initialized or not.
    check(fmu.enter());
    check(fmu.exit());
    let mut omega = [0.0];
    check(fmu.reals(&[reference("derived.omega_v")], &mut omega));
    let mut time = 0.0;
    for _ in 0..3 {
        // SAFETY: the instance lives, and there is a place for the time.
        check(unsafe { rocking_block::fmi::fmi2::exports::fmi2GetRealStatus(fmu.component, 2, &raw mut time) });
        // Short relative to the periods of the block, so ordinary motion takes few steps.
        if fmu.is_quick() {
            check(fmu.step(time, 0.5 / omega[0].max(1.0)));
        }
        check(fmu.set(reference("a_gx"), 3.0));
        check(fmu.reals(&[reference("theta_ddot"), reference("peak.N")], &mut [0.0; 2]));
        check(fmu.rates(&[reference("energy.total")], &[1], &mut [0.0]));
    }
    check(fmu.reset());
}
