//! A choice in a description → that of the solver, by the name of the item. An item that only one of them has does not compile.

/// Returns the item of the solver's type with the same name. The caller has the description's `choices` and the type in scope.
macro_rules! same_named {
    ($chosen:expr, $type:ident: $($item:ident)*) => {
        match $chosen {
            $(choices::$type::$item => $type::$item,)*
        }
    };
}

/// Returns the shape of a pulse.
macro_rules! pulse_shape {
    ($chosen:expr) => {
        $crate::unit::choice::same_named!(
            $chosen,
            PulseShape: None OneSine OneCosine C1 C2 HalfSine Rectangular SymmetricRicker AntisymmetricRicker Gabor
        )
    };
}

/// Returns what follows complete separation.
macro_rules! on_separation {
    ($chosen:expr) => {
        $crate::unit::choice::same_named!($chosen, OnSeparation: Terminate Hold Fly)
    };
}

/// Returns what follows overturning.
macro_rules! on_overturning {
    ($chosen:expr) => {
        $crate::unit::choice::same_named!($chosen, OnOverturning: Terminate Hold)
    };
}

pub(super) use {on_overturning, on_separation, pulse_shape, same_named};
