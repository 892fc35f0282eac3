//! Bytes in the memory of WebAssembly ↔ requests and replies.
//!
//! The host asks for room with [`rocking_input`], writes a request there, and calls [`rocking_call`]. The reply then stands at
//! [`rocking_output`]. Both are four bytes with the length of the JSON (little endian), the JSON, and further bytes. In a reply the
//! JSON ends with blanks such that the further bytes begin at a multiple of eight.

use std::cell::RefCell;

use serde_json::json;

use crate::engine::{Engine, Reply, Request};

#[derive(Default)]
struct Exchange {
    engine: Engine,
    input: Vec<u8>,
    /// In words of eight bytes, so that numbers are aligned.
    output: Vec<u64>,
}

thread_local! {
    static EXCHANGE: RefCell<Exchange> = RefCell::default();
}

/// Returns the address of room for a request of this length (bytes).
#[unsafe(no_mangle)]
pub extern "C" fn rocking_input(length: usize) -> *mut u8 {
    EXCHANGE.with_borrow_mut(|exchange| {
        exchange.input = vec![0; length];
        exchange.input.as_mut_ptr()
    })
}

/// Answers the request, and returns the length of the reply (bytes).
#[unsafe(no_mangle)]
pub extern "C" fn rocking_call() -> usize {
    EXCHANGE.with_borrow_mut(|Exchange { engine, input, output }| {
        let input = std::mem::take(input);
        let reply = match split(&input) {
            Ok((request, bytes)) => engine.answer(request, bytes),
            Err(message) => Reply {
                json: json!({ "ok": false, "errors": [{ "field": "run", "message": message }] }),
                bytes: Vec::new(),
            },
        };
        let bytes = joined(&reply);
        *output = bytes.chunks(8).map(word).collect();
        bytes.len()
    })
}

/// Returns the address of the reply, which stands until the next call.
#[unsafe(no_mangle)]
pub extern "C" fn rocking_output() -> *const u8 {
    EXCHANGE.with_borrow(|exchange| exchange.output.as_ptr().cast())
}

/// Reads the request and the bytes that follow it.
fn split(input: &[u8]) -> Result<(Request, &[u8]), String> {
    let length = input.first_chunk().map(|length| u32::from_le_bytes(*length) as usize);
    let rest = input.get(4..).unwrap_or_default();
    let (json, bytes) = length.and_then(|length| rest.split_at_checked(length)).ok_or("found half a request")?;
    Ok((serde_json::from_slice(json).map_err(|error| error.to_string())?, bytes))
}

fn joined(Reply { json, bytes }: &Reply) -> Vec<u8> {
    let mut json = json.to_string();
    let blanks = (12 - json.len() % 8) % 8;
    json.push_str(&" ".repeat(blanks));
    let mut joined = (json.len() as u32).to_le_bytes().to_vec();
    joined.extend(json.as_bytes());
    joined.extend(bytes);
    joined
}

/// Eight bytes as they stand in memory, the last ones zero if there are fewer.
fn word(bytes: &[u8]) -> u64 {
    let mut word = [0; 8];
    word[..bytes.len()].copy_from_slice(bytes);
    u64::from_ne_bytes(word)
}
