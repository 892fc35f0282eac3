//! Functions of the interface that act on an instance, and the states in which they are legal.

use crate::fmi::Version;
use crate::unit::life_cycle::{Interface, Phase};

/// A function of the interface that acts on an instance.
pub trait Call: Copy {
    /// Returns its name in the standard.
    fn name(self) -> &'static str;

    /// Returns the states in which it is legal, as bits of [`Phase`].
    fn phases(self) -> u16;

    /// Returns the only interface type that has it, or `None` if both have it.
    fn interface(self) -> Option<Interface>;
}

/// Interface type of a function that both have.
pub(super) const BOTH: Option<Interface> = None;

/// Declares the functions of a version: for each interface type the function, its name, and the states in which it is legal.
macro_rules! calls {
    ($($interface:expr => { $($call:ident $name:literal $phases:expr;)* })*) => {
        /// A function of the interface that acts on an instance.
        #[derive(Clone, Copy, Debug, PartialEq, Eq)]
        #[expect(missing_docs, reason = "each is the function of the standard with the same name")]
        pub enum Call {
            $($($call,)*)*
        }

        impl $crate::fmi::calls::Call for Call {
            fn name(self) -> &'static str {
                match self {
                    $($(Call::$call => $name,)*)*
                }
            }

            #[inline]
            fn phases(self) -> u16 {
                match self {
                    $($(Call::$call => $phases,)*)*
                }
            }

            #[inline]
            fn interface(self) -> Option<Interface> {
                match self {
                    $($(Call::$call)|* => $interface,)*
                }
            }
        }
    };
}
pub(super) use calls;

/// Refuses a call that is illegal in this state, or that the interface type does not have.
///
/// # Errors
/// The states in which the call is legal.
#[inline]
pub fn admit<V: Version>(call: V::Call, phase: Phase, interface: Interface) -> Result<(), String> {
    if call.phases() & phase.bit() != 0 && call.interface().is_none_or(|needed| needed == interface) {
        return Ok(());
    }
    Err(refusal::<V>(call, phase, interface))
}

/// Returns the reason for a refusal, with the states that allow the call.
#[cold]
fn refusal<V: Version>(call: V::Call, phase: Phase, interface: Interface) -> String {
    if let Some(needed) = call.interface().filter(|needed| *needed != interface) {
        let words = |interface| match interface {
            Interface::CoSimulation => "Co-Simulation",
            Interface::ModelExchange => "Model Exchange",
        };
        return format!("found an instance for {}; expected one for {}", words(interface), words(needed));
    }
    if call.phases() == 0 {
        return V::missing(call).into();
    }
    let allowed = call.phases() & V::reached(interface);
    let allowed = Phase::ALL.into_iter().filter(|phase| allowed & phase.bit() != 0);
    let allowed: Vec<&str> = allowed.map(V::state).collect();
    format!("not allowed in {}; expected {}", V::state(phase), allowed.join(", "))
}
