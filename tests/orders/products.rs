//! Measured orders on products of groups and on SE(3): every method of the catalog for fields, on fields
//! that couple the parts. The harness is that of `fields.rs`.

use crate::support::orders::{
    clocks, every_explicit_method_on, every_linear_method_on, every_method_on, waves,
};
use lieflow::actions::{Coadjoint, LeftTranslation, Pair};
use lieflow::groups::{MatrixGroup, Power, Product, Se3, So3};

fn product() -> Product<So3, MatrixGroup> {
    Product(So3::new(), MatrixGroup::sp(4).unwrap())
}
fn power() -> Power<So3> {
    Power::new(So3::new(), 2).unwrap()
}

crate::orders! {
    every_method_on:
    translation_on_a_product: many, product(), LeftTranslation, waves(7, 0.25, 11);
    translation_on_a_power: many, power(), LeftTranslation, waves(6, 0.25, 13);
    translation_on_se3: many, Se3::new(), LeftTranslation, waves(4, 0.5, 23);
}

crate::orders! {
    every_explicit_method_on:
    orbits_of_se3: one, Se3::new(), Coadjoint, waves(4, 0.5, 22);
    an_action_for_each_part: one, product(), Pair(Coadjoint, LeftTranslation), waves(7, 0.5, 15);
}

crate::orders! {
    every_linear_method_on:
    linear_on_a_product: many, product(), LeftTranslation, clocks(7, 0.5);
    linear_on_a_power: many, power(), LeftTranslation, clocks(6, 0.7);
    linear_on_se3: many, Se3::new(), LeftTranslation, clocks(4, 1.0);
}
