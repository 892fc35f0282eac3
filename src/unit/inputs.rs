//! The inputs among the variables of modelDescription.xml ↔ ramps.

use std::ops::{Index, IndexMut};

use crate::excitation::{Inputs, Ramp};
use crate::unit::variables::Input;

impl Index<Input> for Inputs {
    type Output = Ramp;

    fn index(&self, input: Input) -> &Ramp {
        match input {
            Input::AGx => &self.a_gx,
            Input::AGz => &self.a_gz,
            Input::FX => &self.f_x,
            Input::FZ => &self.f_z,
            Input::MY => &self.m_y,
        }
    }
}

impl IndexMut<Input> for Inputs {
    fn index_mut(&mut self, input: Input) -> &mut Ramp {
        match input {
            Input::AGx => &mut self.a_gx,
            Input::AGz => &mut self.a_gz,
            Input::FX => &mut self.f_x,
            Input::FZ => &mut self.f_z,
            Input::MY => &mut self.m_y,
        }
    }
}
