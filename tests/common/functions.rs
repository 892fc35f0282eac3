//! Functions of a library, loaded by name as by an importer.

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
