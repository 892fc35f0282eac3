//! The interfaces of FMI-LS-WASM (`wit/fmi3.wit`) as a component exports them, over the C interface of FMI 3.0.
//!
//! A component implements one world: Co-Simulation, or Model Exchange with the feature `model-exchange`. [`methods`] has the methods
//! of both, and [`instance`] the instance behind them.

/// The code that wit-bindgen writes.
#[allow(missing_docs, clippy::undocumented_unsafe_blocks, unsafe_op_in_unsafe_fn, reason = "it is generated")]
mod bindings {
    #[cfg(not(feature = "model-exchange"))]
    wit_bindgen::generate!({ world: "co-simulation-fmu", path: "wit" });
    #[cfg(feature = "model-exchange")]
    wit_bindgen::generate!({ world: "model-exchange-fmu", path: "wit" });

    export!(Component with_types_in self);

    struct Component;

    impl exports::fmi::fmi3::common::Guest for Component {
        fn get_version() -> String {
            "3.0".into()
        }
    }

    #[cfg(not(feature = "model-exchange"))]
    impl exports::fmi::fmi3::co_simulation::Guest for Component {
        type CoSimulationInstance = crate::instance::Instance;
    }

    #[cfg(feature = "model-exchange")]
    impl exports::fmi::fmi3::model_exchange::Guest for Component {
        type ModelExchangeInstance = crate::instance::Instance;
    }
}

#[macro_use]
mod methods;

#[cfg(not(feature = "model-exchange"))]
mod co_simulation;
mod instance;
#[cfg(feature = "model-exchange")]
mod model_exchange;
