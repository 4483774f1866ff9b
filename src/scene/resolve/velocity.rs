//! The ways to give a velocity.

use std::ops::Range;

use glam::DVec3;

use super::context::Context;
use crate::error::{Error, Result};
use crate::scene::at::At;
use crate::scene::file;
use crate::scene::values::NumberOrVector::{Number, Vector};
use crate::spacetime::{Velocity, VelocityError};

const HELP: &str = "give it in one way: { beta = [0.9, 0, 0] }, { beta = 0.9, direction = [1, 0, 0] }, \
                    { gamma = 7, direction = … }, { rapidity = [2, 0, 0] }, { rapidity = 2, direction = … } \
                    or { one_minus_beta = 1e-9, direction = … }";

/// The velocity in the file; at rest by default.
pub(super) fn resolve(cx: &Context, velocity: &Option<At<file::Velocity>>) -> Result<Velocity> {
    let Some(velocity) = velocity else {
        return Ok(Velocity::REST);
    };
    said(cx, &velocity.value, &velocity.span, DVec3::ZERO)
}

/// The velocity in the table `v` at `span`; a number without a direction is along `otherwise`.
pub(crate) fn said(
    cx: &Context,
    v: &file::Velocity,
    span: &Range<usize>,
    otherwise: DVec3,
) -> Result<Velocity> {
    let ways = [
        ("beta", At::span_of(&v.beta)),
        ("gamma", At::span_of(&v.gamma)),
        ("rapidity", At::span_of(&v.rapidity)),
        ("one_minus_beta", At::span_of(&v.one_minus_beta)),
    ];
    cx.only_one("the velocity", ways, HELP)?;
    let said = Said { cx, v, otherwise };
    if let Some(beta) = &v.beta {
        return match beta.value {
            Vector(vector) => said.vector(beta, vector, Velocity::from_beta),
            Number(beta_number) => said.along(beta, beta_number, from_signed_beta),
        };
    }
    if let Some(rapidity) = &v.rapidity {
        return match rapidity.value {
            Vector(vector) => said.vector(rapidity, vector, Velocity::from_rapidity),
            Number(magnitude) => said.along(rapidity, magnitude, |w, d| {
                Velocity::from_rapidity_along(w, d)
            }),
        };
    }
    if let Some(gamma) = &v.gamma {
        return said.along(gamma, gamma.value.0, Velocity::from_gamma);
    }
    if let Some(q) = &v.one_minus_beta {
        return said.along(q, q.value.0, Velocity::from_one_minus_beta);
    }
    Err(cx.report.refuse(span, "no velocity is given", HELP))
}

/// β along a direction; a negative one is against it.
pub(crate) fn from_signed_beta(beta: f64, direction: DVec3) -> Result<Velocity, VelocityError> {
    if beta.abs() >= 1.0 {
        return Err(VelocityError::NotSlowerThanLight(beta.abs()));
    }
    Velocity::from_rapidity_along(libm::atanh(beta), direction)
}

/// A velocity's table while it is read.
struct Said<'a> {
    cx: &'a Context,
    v: &'a file::Velocity,
    /// The default direction for numbers; 0 if a direction is required.
    otherwise: DVec3,
}

impl Said<'_> {
    /// A vector, which needs no direction.
    fn vector<T>(
        &self,
        at: &At<T>,
        vector: [f64; 3],
        velocity: fn(DVec3) -> Result<Velocity, VelocityError>,
    ) -> Result<Velocity> {
        if let Some(direction) = &self.v.direction {
            let what = "a vector has its own direction";
            let help = "leave `direction` out, or give a number with it";
            let other = (&at.span, "this vector");
            return Err(self
                .cx
                .report
                .refuse_two(&direction.span, other, what, help));
        }
        velocity(DVec3::from_array(vector)).map_err(|error| self.refuse(at, error))
    }

    /// A number along the table's direction.
    fn along<T>(
        &self,
        at: &At<T>,
        number: f64,
        velocity: fn(f64, DVec3) -> Result<Velocity, VelocityError>,
    ) -> Result<Velocity> {
        let direction = self.v.direction.as_ref();
        let vector = direction.map_or(self.otherwise, |direction| direction.value.vec());
        velocity(number, vector).map_err(|error| match (error, direction) {
            (VelocityError::NoDirection, Some(direction)) => self.refuse(direction, error),
            (VelocityError::NoDirection, None) => {
                let what = "a number alone has no direction of motion";
                self.cx
                    .refuse(at, what, "add direction = [1, 0, 0], or the like")
            }
            _ => self.refuse(at, error),
        })
    }

    fn refuse<T>(&self, at: &At<T>, error: VelocityError) -> Error {
        refusal(self.cx, &at.span, error)
    }
}

/// The error for a velocity at `span`.
pub(crate) fn refusal(cx: &Context, span: &Range<usize>, error: VelocityError) -> Error {
    let help = match error {
        VelocityError::NotSlowerThanLight(_) => {
            "|β| is below 1; for speeds so near 1 that β rounds to it, give one_minus_beta, gamma \
                 or rapidity"
        }
        VelocityError::GammaBelowOne(_) => "γ = 1/√(1 − β²) is at least 1",
        VelocityError::OneMinusBeta(_) => "1 − β is above 0 and at most 1, which is rest",
        VelocityError::NoDirection => "any direction of length above 0 will do",
        VelocityError::TooFast(_) => "give a smaller rapidity",
        VelocityError::NotFinite => "give finite numbers",
    };
    cx.report.refuse(span, error.to_string(), help)
}
