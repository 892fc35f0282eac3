//! Bytes in the memory of WebAssembly ↔ requests and replies.
//!
//! The host requests memory with [`rocking_input`], writes a request there, and calls [`rocking_call`]. The reply is then at
//! [`rocking_output`]. Both are four bytes with the length of the JSON (little endian), the JSON, and further bytes.

use std::cell::RefCell;

use serde_json::json;

use crate::engine::{Engine, Reply, Request};

#[derive(Default)]
struct Exchange {
    engine: Engine,
    input: Vec<u8>,
    output: Vec<u8>,
}

thread_local! {
    static EXCHANGE: RefCell<Exchange> = RefCell::default();
}

/// Returns the address of memory for a request of this length (bytes).
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
        *output = joined(&reply);
        output.len()
    })
}

/// Returns the address of the reply, which is valid until the next call.
#[unsafe(no_mangle)]
pub extern "C" fn rocking_output() -> *const u8 {
    EXCHANGE.with_borrow(|exchange| exchange.output.as_ptr())
}

/// Reads the request and the bytes that follow it.
fn split(input: &[u8]) -> Result<(Request, &[u8]), String> {
    let length = input.first_chunk().map(|length| u32::from_le_bytes(*length) as usize);
    let rest = input.get(4..).unwrap_or_default();
    let (json, bytes) = length.and_then(|length| rest.split_at_checked(length)).ok_or("found half a request")?;
    Ok((serde_json::from_slice(json).map_err(|error| error.to_string())?, bytes))
}

fn joined(Reply { json, bytes }: &Reply) -> Vec<u8> {
    let json = json.to_string();
    [&(json.len() as u32).to_le_bytes(), json.as_bytes(), bytes].concat()
}
