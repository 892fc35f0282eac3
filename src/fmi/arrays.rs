//! The importer's pointers → slices, strings and memory for results.
//!
//! [`boundary`](crate::fmi::boundary) lists the importer's obligations.

use std::borrow::Cow;
use std::ffi::{CStr, c_char};
use std::marker::PhantomData;
use std::mem::MaybeUninit;

use crate::fmi::size_t;
use crate::unit::fault::Fault;

/// Refuses a pointer that cannot be an array of `count` elements.
#[inline(always)]
fn usable<T>(name: &str, pointer: *const T, count: size_t) -> Result<(), Fault> {
    let fits = count <= isize::MAX as usize / size_of::<T>();
    if pointer.is_null() || !pointer.is_aligned() || !fits {
        return Err(refused(name, pointer.cast(), align_of::<T>(), count));
    }
    Ok(())
}

/// Returns the reason why a pointer cannot be an array of `count` elements.
#[cold]
#[inline(never)]
fn refused(name: &str, pointer: *const (), multiple: usize, count: size_t) -> Fault {
    Fault::new(if pointer.is_null() {
        format!("{name} is NULL; expected {count} elements")
    } else if !pointer.addr().is_multiple_of(multiple) {
        format!("{name} is at {pointer:p}; expected a multiple of {multiple}")
    } else {
        format!("{name} has {count} elements; expected a number that fits into memory")
    })
}

/// Returns an array for reading.
///
/// # Safety
/// `pointer` is null or points to `count` elements that nothing changes meanwhile (standard, 2.1.7).
///
/// # Errors
/// The pointer is null or not aligned, or the elements would not fit into memory.
#[inline(always)]
pub unsafe fn read<'a, T>(name: &str, pointer: *const T, count: size_t) -> Result<&'a [T], Fault> {
    if count == 0 {
        return Ok(&[]);
    }
    usable(name, pointer, count)?;
    // SAFETY: not null, aligned and of a possible length; by contract `count` elements (standard, 2.1.7).
    Ok(unsafe { std::slice::from_raw_parts(pointer, count) })
}

/// The importer's memory for results. It is never read, since it may be uninitialized.
pub struct OutputArray<'a, T> {
    pointer: *mut T,
    count: usize,
    memory: PhantomData<&'a mut [MaybeUninit<T>]>,
}

/// Returns an array for writing.
///
/// # Safety
/// `pointer` is null or points to memory for `count` elements that nothing else uses meanwhile (standard, 2.1.7), except
/// arrays that are read by [`OutputArray::read_input`].
///
/// # Errors
/// Those of [`read`].
pub unsafe fn output_array<'a, T>(name: &str, pointer: *mut T, count: size_t) -> Result<OutputArray<'a, T>, Fault> {
    if count > 0 {
        usable(name, pointer, count)?;
    }
    Ok(OutputArray { pointer, count, memory: PhantomData })
}

impl<'a, T> OutputArray<'a, T> {
    /// Returns an array for reading while this one is written. It is a copy if the two share memory.
    ///
    /// # Safety
    /// As for [`read`].
    ///
    /// # Errors
    /// Those of [`read`].
    pub unsafe fn read_input<U: Copy>(
        &self,
        name: &str,
        pointer: *const U,
        count: size_t,
    ) -> Result<Cow<'a, [U]>, Fault> {
        // SAFETY: by contract; a slice that shares memory with this array is dropped before anything is written.
        let array = unsafe { read(name, pointer, count) }?;
        let (here, there) = (self.pointer.addr(), array.as_ptr().addr());
        let apart = here + self.count * size_of::<T>() <= there || there + size_of_val(array) <= here;
        Ok(if apart || self.count == 0 { Cow::Borrowed(array) } else { Cow::Owned(array.to_vec()) })
    }

    /// Returns the elements.
    pub fn elements(&mut self) -> &mut [MaybeUninit<T>] {
        if self.count == 0 {
            return &mut [];
        }
        // SAFETY: not null, aligned and of a possible length (see `output_array`); by its contract memory for `count` elements
        // (standard, 2.1.7), whose content is not assumed, and by that of `read_input` no slice shares it.
        unsafe { std::slice::from_raw_parts_mut(self.pointer.cast(), self.count) }
    }

    /// Writes a single result.
    pub fn put(mut self, value: T) {
        if let [element] = self.elements() {
            element.write(value);
        }
    }
}

impl OutputArray<'_, u8> {
    /// Copies bytes to the beginning of the array.
    ///
    /// # Errors
    /// The array is shorter than the bytes.
    pub fn copy(&mut self, bytes: &[u8]) -> Result<(), Fault> {
        let (found, needed) = (self.count, bytes.len());
        let elements = self.elements().get_mut(..needed);
        let elements = elements.ok_or_else(|| Fault::new(format!("room for {found} bytes; expected {needed}")))?;
        elements.write_copy_of_slice(bytes);
        Ok(())
    }
}

/// Returns the memory for a single result.
///
/// # Safety
/// As for [`output_array`], with one element.
///
/// # Errors
/// The pointer is null or not aligned.
pub unsafe fn single_output<'a, T>(name: &str, pointer: *mut T) -> Result<OutputArray<'a, T>, Fault> {
    if pointer.is_null() {
        return Err(Fault::new(format!("{name} is NULL; expected a pointer to memory for the result")));
    }
    // SAFETY: by contract.
    unsafe { output_array(name, pointer, 1) }
}

/// Returns a C string.
///
/// # Safety
/// `pointer` is null or points to a string that ends with 0 (standard, 2.1.2) and that nothing changes meanwhile.
pub unsafe fn text<'a>(pointer: *const c_char) -> Option<&'a CStr> {
    // SAFETY: not null here, and by contract a string that ends with 0 (standard, 2.1.2).
    (!pointer.is_null()).then(|| unsafe { CStr::from_ptr(pointer) })
}

/// Returns the strings of an array.
///
/// # Safety
/// As for [`read`], and each element is null or points to a string that ends with 0 (standard, 2.1.2) and does not change meanwhile.
///
/// # Errors
/// Those of [`read`], a null element, or a string that is not UTF-8.
pub unsafe fn texts<'a>(name: &str, pointer: *const *const c_char, count: size_t) -> Result<Vec<&'a str>, Fault> {
    // SAFETY: by contract an array of `count` pointers (standard, 2.1.5).
    let pointers = unsafe { read(name, pointer, count) }?;
    pointers
        .iter()
        .map(|&pointer| {
            // SAFETY: by contract null or a string that ends with 0 (standard, 2.1.2).
            let text =
                unsafe { text(pointer) }.ok_or_else(|| Fault::new(format!("{name} holds NULL; expected texts")))?;
            text.to_str().map_err(|_| Fault::new(format!("{name} holds {text:?}; expected UTF-8")))
        })
        .collect()
}

#[cfg(test)]
mod tests {
    use super::*;

    /// An array that shares memory with the results is copied before these are written.
    #[test]
    fn arrays_may_overlap() {
        let mut memory = [1.0, 2.0, 3.0, 4.0, 5.0];
        let start = memory.as_mut_ptr();
        for shift in [0, 1, 2] {
            memory = [1.0, 2.0, 3.0, 4.0, 5.0];
            let start = memory.as_mut_ptr();
            // SAFETY: within the memory.
            let mut output = unsafe { output_array("output", start.add(shift), 5 - shift) }.unwrap();
            // SAFETY: as before.
            let array = unsafe { output.read_input("array", start.cast_const(), 5 - shift) }.unwrap();
            assert!(matches!(array, Cow::Owned(_)));
            output
                .elements()
                .iter_mut()
                .zip(array.iter())
                .for_each(|(element, &value)| _ = element.write(10.0 * value));
            let tenfold: Vec<f64> = (1..=5 - shift).map(|i| 10.0 * i as f64).collect();
            assert_eq!(memory[shift..], tenfold);
        }
        // SAFETY: two parts of the memory that touch and do not overlap.
        let array = unsafe {
            let output = output_array("output", start.add(2), 3).unwrap();
            output.read_input("array", start.cast_const(), 2).unwrap()
        };
        assert!(matches!(array, Cow::Borrowed([..])));
    }

    #[test]
    fn impossible_arrays_are_refused() {
        let number = 1.0_f64;
        let pointer = &raw const number;
        let refuse = |pointer: *const f64, count, words: &str| {
            let fault = usable("value", pointer, count).unwrap_err();
            assert!(fault.0.contains(words), "{fault}");
        };
        refuse(std::ptr::null(), 1, "value is NULL; expected 1 elements");
        refuse(pointer.wrapping_byte_add(4), 1, "expected a multiple of 8");
        refuse(pointer, usize::MAX / 8, "expected a number that fits into memory");
        usable("value", pointer, isize::MAX as usize / 8).unwrap();
    }
}
