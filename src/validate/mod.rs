//! Whether a picture is right, and what accuracy costs: comparison, bundles for other programs, studies, the self-test.

#[doc = include_str!("guide.md")]
pub mod guide {}

pub mod compare;
pub mod export;
pub mod selftest;
pub mod study;
