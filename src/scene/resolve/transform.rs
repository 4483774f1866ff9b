//! Object coordinates from the file's: x = T + R S x_file, or one matrix.

use glam::{DAffine3, DMat3, DVec3};

use super::context::Context;
use crate::error::Result;
use crate::scene::at::At;
use crate::scene::file::{Rotation, Transform};
use crate::scene::limits;
use crate::scene::values::{NumberOrVector, Numbers};

pub(super) fn resolve(cx: &Context, transform: &Option<At<Transform>>) -> Result<DAffine3> {
    let Some(at) = transform else {
        return Ok(DAffine3::IDENTITY);
    };
    let transform = match &at.value.matrix {
        Some(matrix) => from_matrix(cx, &at.value, matrix)?,
        None => from_parts(cx, &at.value)?,
    };
    let span = at
        .value
        .matrix
        .as_ref()
        .map_or(&at.span, |matrix| &matrix.span);
    let span = at.value.scale.as_ref().map_or(span, |scale| &scale.span);
    if limits::is_invertible(transform) {
        return Ok(transform);
    }
    let what = "this transform is singular: it flattens the object";
    let help = "give scale factors that are not 0, or a matrix whose columns span space";
    Err(cx.report.refuse(span, what, help))
}

fn from_parts(cx: &Context, transform: &Transform) -> Result<DAffine3> {
    let scale = match transform.scale.as_ref().map(|scale| scale.value) {
        Some(NumberOrVector::Number(factor)) => DVec3::splat(factor),
        Some(NumberOrVector::Vector(factors)) => DVec3::from_array(factors),
        None => DVec3::ONE,
    };
    let rotation = transform.rotate.as_ref();
    let rotation = rotation.map_or(Ok(DMat3::IDENTITY), |rotate| rotation_matrix(cx, rotate))?;
    let translation = transform.translate.as_ref();
    Ok(DAffine3 {
        matrix3: rotation * DMat3::from_diagonal(scale),
        translation: translation.map_or(DVec3::ZERO, |translate| translate.value.vec()),
    })
}

/// Rodrigues' formula: R = cos θ I + sin θ [a]× + (1 − cos θ) a aᵀ.
fn rotation_matrix(cx: &Context, rotate: &At<Rotation>) -> Result<DMat3> {
    let Rotation { axis, angle } = &rotate.value;
    let a = cx.unit(axis, "the axis of rotation", "give an axis like [0, 1, 0]")?;
    let (sin, cos) = angle.value.sin_cos();
    let column = |e: DVec3| e * cos + a.cross(e) * sin + a * (a.dot(e) * (1.0 - cos));
    Ok(DMat3::from_cols(
        column(DVec3::X),
        column(DVec3::Y),
        column(DVec3::Z),
    ))
}

fn from_matrix(cx: &Context, parts: &Transform, matrix: &At<Numbers<16>>) -> Result<DAffine3> {
    let own = || (&parts.matrix, "matrix");
    cx.exclusive(own(), (&parts.translate, "translate"))?;
    cx.exclusive(own(), (&parts.rotate, "rotate"))?;
    cx.exclusive(own(), (&parts.scale, "scale"))?;
    let [a, b, c, x, d, e, f, y, g, h, i, z, last @ ..] = matrix.value.0;
    if last != [0.0, 0.0, 0.0, 1.0] {
        let what = "the last row of the matrix is not 0, 0, 0, 1";
        let help = "give the 16 numbers by rows, the translation in the last column";
        return Err(cx.refuse(matrix, what, help));
    }
    // Rows in place of columns: the transpose.
    let rows = DMat3::from_cols_array(&[a, b, c, d, e, f, g, h, i]);
    Ok(DAffine3 {
        matrix3: rows.transpose(),
        translation: DVec3::new(x, y, z),
    })
}
