//! Domains.
pub mod plc;
