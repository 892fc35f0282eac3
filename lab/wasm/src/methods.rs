//! The methods that the resources of Co-Simulation and Model Exchange have in common.

/// The methods of both resources, for the body of an `impl` for [`crate::instance::Instance`].
///
/// wit-bindgen makes a trait for each resource, so that the methods are expanded in each.
macro_rules! common_methods {
    () => {
        fn set_debug_logging(&self, logging_on: bool, categories: Vec<String>) -> Status {
            let categories: Vec<&str> = categories.iter().map(String::as_str).collect();
            self.call(Call::SetDebugLogging, |unit| unit.set_debug_logging(logging_on, &categories))
        }

        fn enter_initialization_mode(&self, tolerance: Option<f64>, start_time: f64, stop_time: Option<f64>) -> Status {
            let act = |unit: &mut Unit| unit.enter_initialization_mode(tolerance, start_time, stop_time);
            self.call(Call::EnterInitializationMode, act)
        }

        transitions! {
            exit_initialization_mode ExitInitializationMode Unit::leave_initialization_mode;
            enter_event_mode EnterEventMode Unit::begin_event;
            enter_step_mode EnterStepMode Unit::enter_step_mode;
            terminate Terminate moves_to(Phase::Terminated);
            reset Reset always(Fmu::reset);
            enter_configuration_mode EnterConfigurationMode moves_to(Phase::ConfigurationMode);
            exit_configuration_mode ExitConfigurationMode moves_to(Phase::Instantiated);
        }

        fn update_discrete_states(&self) -> Result<DiscreteStatesInfo, Status> {
            self.update()
        }

        accessors! {
            get_float64 set_float64 GetFloat64 SetFloat64 f64, Unit::get_floats, Unit::set_floats;
            get_int32 set_int32 GetInt32 SetInt32 i32,
                |unit, of, values| unit.get_scalars(Kind::Integer, of, values, |value| value as i32),
                |unit, of, values| unit.set_scalars(Kind::Integer, of, values, f64::from);
            get_int64 set_int64 GetInt64 SetInt64 i64,
                |unit, of, values| unit.get_scalars(Kind::Enumeration, of, values, |value| value as i64),
                |unit, of, values| unit.set_scalars(Kind::Enumeration, of, values, |value| value as f64);
            get_boolean set_boolean GetBoolean SetBoolean bool,
                |unit, of, values| unit.get_scalars(Kind::Boolean, of, values, |value| value != 0.0),
                |unit, of, values| unit.set_scalars(Kind::Boolean, of, values, |value| f64::from(u8::from(value)));
            get_uint64 set_uint64 GetUInt64 SetUInt64 u64, Unit::get_sizes, Unit::set_sizes;
        }

        fn get_string(&self, value_references: Vec<u32>) -> Result<Vec<String>, Status> {
            self.ask(Call::GetString, |unit| {
                unit.check_texts(&value_references, value_references.len())?;
                let texts = unit.get_texts(&value_references)?;
                Ok(texts.iter().map(|text| text.to_string_lossy().into_owned()).collect())
            })
        }

        fn set_string(&self, value_references: Vec<u32>, values: Vec<String>) -> Status {
            let texts: Vec<&str> = values.iter().map(String::as_str).collect();
            self.call(Call::SetString, |unit| {
                unit.check_texts(&value_references, texts.len())?;
                unit.set_texts(&value_references, &texts)
            })
        }

        missing_types! {
            get_float32 set_float32 GetFloat32 SetFloat32 f32, "Float32";
            get_int8 set_int8 GetInt8 SetInt8 i8, "Int8";
            get_uint8 set_uint8 GetUInt8 SetUInt8 u8, "UInt8";
            get_int16 set_int16 GetInt16 SetInt16 i16, "Int16";
            get_uint16 set_uint16 GetUInt16 SetUInt16 u16, "UInt16";
            get_uint32 set_uint32 GetUInt32 SetUInt32 u32, "UInt32";
            get_binary set_binary GetBinary SetBinary Vec<u8>, "Binary";
        }

        fn get_fmu_state(&self) -> Result<Vec<u8>, Status> {
            self.ask(Call::GetFmuState, |unit| snapshot::serialize(&unit.unit))
        }

        fn set_fmu_state(&self, state: Vec<u8>) -> Status {
            self.call(Call::SetFmuState, |unit| unit.restore(&snapshot::deserialize(&state)?))
        }

        fn get_directional_derivative(
            &self,
            unknowns: Vec<u32>,
            knowns: Vec<u32>,
            seed: Vec<f64>,
        ) -> Result<Vec<f64>, Status> {
            self.get(
                Call::GetDirectionalDerivative,
                |_| unknowns.len(),
                |unit, sensitivities| unit.directional(&unknowns, &knowns, &seed, sensitivities),
            )
        }

        fn get_adjoint_derivative(
            &self,
            unknowns: Vec<u32>,
            knowns: Vec<u32>,
            seed: Vec<f64>,
        ) -> Result<Vec<f64>, Status> {
            self.get(
                Call::GetAdjointDerivative,
                |unit| unit.value_count(&knowns),
                |unit, sensitivities| unit.adjoint_derivative(&unknowns, &knowns, &seed, sensitivities),
            )
        }

        fn get_output_derivatives(&self, requests: Vec<(u32, u32)>) -> Result<Vec<f64>, Status> {
            let (references, orders): (Vec<u32>, Vec<i32>) = requests
                .iter()
                .map(|&(reference, order)| (reference, i32::try_from(order).unwrap_or(i32::MAX)))
                .unzip();
            self.get(
                Call::GetOutputDerivatives,
                |_| references.len(),
                |unit, values| unit.derivatives(&references, &orders, values),
            )
        }

        missing! {
            get_clock GetClock (Vec<u32>) -> Vec<bool>;
            get_number_of_variable_dependencies GetNumberOfVariableDependencies (u32) -> u64;
            get_variable_dependencies GetVariableDependencies (u32) -> Vec<VariableDependency>;
            get_interval_decimal GetIntervalDecimal (Vec<u32>) -> Vec<(f64, IntervalQualifier)>;
            get_interval_fraction GetIntervalFraction (Vec<u32>) -> Vec<(IntervalFraction, IntervalQualifier)>;
            get_shift_decimal GetShiftDecimal (Vec<u32>) -> Vec<f64>;
            get_shift_fraction GetShiftFraction (Vec<u32>) -> Vec<IntervalFraction>;
        }

        fn set_clock(&self, _: Vec<u32>, _: Vec<bool>) -> Status {
            self.refuse(Call::SetClock)
        }

        fn set_interval_decimal(&self, _: Vec<u32>, _: Vec<f64>) -> Status {
            self.refuse(Call::SetIntervalDecimal)
        }

        fn set_interval_fraction(&self, _: Vec<u32>, _: Vec<IntervalFraction>) -> Status {
            self.refuse(Call::SetIntervalFraction)
        }

        fn set_shift_decimal(&self, _: Vec<u32>, _: Vec<f64>) -> Status {
            self.refuse(Call::SetShiftDecimal)
        }

        fn set_shift_fraction(&self, _: Vec<u32>, _: Vec<IntervalFraction>) -> Status {
            self.refuse(Call::SetShiftFraction)
        }

        fn evaluate_discrete_states(&self) -> Status {
            self.refuse(Call::EvaluateDiscreteStates)
        }
    };
}

/// Calls without arguments.
macro_rules! transitions {
    ($($name:ident $call:ident $act:expr;)*) => {$(
        fn $name(&self) -> Status {
            self.call(Call::$call, $act)
        }
    )*};
}

/// Getter and setter of a type.
macro_rules! accessors {
    ($($get:ident $set:ident $get_call:ident $set_call:ident $type:ty, $read:expr, $write:expr;)*) => {$(
        fn $get(&self, value_references: Vec<u32>) -> Result<Vec<$type>, Status> {
            let read: fn(&mut Unit, &[u32], &mut [MaybeUninit<$type>]) -> Answer = $read;
            let count = |unit: &Unit| unit.value_count(&value_references);
            self.get(Call::$get_call, count, |unit, values| read(unit, &value_references, values))
        }

        fn $set(&self, value_references: Vec<u32>, values: Vec<$type>) -> Status {
            let write: fn(&mut Unit, &[u32], &[$type]) -> Answer = $write;
            self.call(Call::$set_call, |unit| write(unit, &value_references, &values))
        }
    )*};
}

/// Getter and setter of a type that no variable has.
macro_rules! missing_types {
    ($($get:ident $set:ident $get_call:ident $set_call:ident $type:ty, $name:literal;)*) => {$(
        fn $get(&self, value_references: Vec<u32>) -> Result<Vec<$type>, Status> {
            self.ask(Call::$get_call, |_| of_no_type::<State>(&value_references, $name).map(|_| Vec::new()))
        }

        fn $set(&self, value_references: Vec<u32>, _: Vec<$type>) -> Status {
            self.call(Call::$set_call, |_| of_no_type::<State>(&value_references, $name))
        }
    )*};
}

/// Calls that are never legal.
macro_rules! missing {
    ($($name:ident $call:ident ($argument:ty) -> $result:ty;)*) => {$(
        fn $name(&self, _: $argument) -> Result<$result, Status> {
            Err(self.refuse(Call::$call))
        }
    )*};
}
