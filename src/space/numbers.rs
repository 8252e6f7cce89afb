//! Points as lists of numbers.

use nalgebra::{Matrix3, UnitQuaternion, Vector3};

use crate::scalar::{Counted, DoubleDouble, Real};

/// A point whose numbers can be listed, so that a state can be saved.
pub trait Numbers {
    /// Call `each` with every number, always in the same order.
    fn each_number(&mut self, each: &mut dyn FnMut(&mut f64));
}

impl Numbers for f64 {
    fn each_number(&mut self, each: &mut dyn FnMut(&mut f64)) {
        each(self);
    }
}

impl Numbers for f32 {
    fn each_number(&mut self, each: &mut dyn FnMut(&mut f64)) {
        let mut x = f64::from(*self);
        each(&mut x);
        *self = x as f32;
    }
}

impl Numbers for DoubleDouble {
    fn each_number(&mut self, each: &mut dyn FnMut(&mut f64)) {
        each(&mut self.hi);
        each(&mut self.lo);
    }
}

impl Numbers for Counted {
    fn each_number(&mut self, each: &mut dyn FnMut(&mut f64)) {
        self.0.each_number(each);
    }
}

impl<S: Real + Numbers> Numbers for Vector3<S> {
    fn each_number(&mut self, each: &mut dyn FnMut(&mut f64)) {
        self.as_mut_slice().iter_mut().for_each(|x| x.each_number(each));
    }
}

impl<S: Real + Numbers> Numbers for Matrix3<S> {
    fn each_number(&mut self, each: &mut dyn FnMut(&mut f64)) {
        self.as_mut_slice().iter_mut().for_each(|x| x.each_number(each));
    }
}

impl Numbers for UnitQuaternion<f64> {
    fn each_number(&mut self, each: &mut dyn FnMut(&mut f64)) {
        self.as_mut_unchecked().coords.iter_mut().for_each(each);
    }
}

impl<A: Numbers, B: Numbers> Numbers for (A, B) {
    fn each_number(&mut self, each: &mut dyn FnMut(&mut f64)) {
        self.0.each_number(each);
        self.1.each_number(each);
    }
}

impl<A: Numbers, const N: usize> Numbers for [A; N] {
    fn each_number(&mut self, each: &mut dyn FnMut(&mut f64)) {
        self.iter_mut().for_each(|part| part.each_number(each));
    }
}

impl<A: Numbers> Numbers for Box<[A]> {
    fn each_number(&mut self, each: &mut dyn FnMut(&mut f64)) {
        self.iter_mut().for_each(|part| part.each_number(each));
    }
}
