//! Functions of a library, loaded by name as by an importer.

use std::collections::BTreeSet;

use object::{Object, ObjectSymbol};

macro_rules! functions {
    ($($field:ident $name:literal ($($argument:ty),*) $(-> $result:ty)?;)*) => {
        /// One pointer per function.
        pub struct Functions {
            $(pub $field: unsafe extern "C" fn($($argument),*) $(-> $result)?,)*
        }

        /// Names of all functions.
        pub const NAMES: &[&str] = &[$($name),*];

        impl Functions {
            /// Looks up all functions.
            pub fn load(library: &libloading::Library) -> Functions {
                // SAFETY: the types are those of the standard's headers, and the library is never unloaded.
                unsafe {
                    Functions { $($field: *library.get($name).unwrap_or_else(|error| panic!("{}: {error}", $name)),)* }
                }
            }
        }
    };
}

pub(crate) use functions;

/// Returns the names that a library exports.
pub fn exports(library: &[u8]) -> BTreeSet<String> {
    let file = object::File::parse(library).unwrap();
    let exported = file.dynamic_symbols().filter(|symbol| symbol.is_definition() && symbol.is_global());
    exported.map(|symbol| symbol.name().unwrap().to_string()).collect()
}
