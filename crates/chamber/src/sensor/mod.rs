//! Characteristics of the sensors: platinum resistance thermometers and thermocouples of type K.

pub mod pt100;
pub mod type_k;
