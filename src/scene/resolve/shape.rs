//! Built-in shapes.

use super::context::Context;
use crate::error::{Result, number};
use crate::scene::at::At;
use crate::scene::file;
use crate::scene::limits;
use crate::scene::model::Shape;

const HELP: &str = "give exactly one shape: { box = { size = [1, 1, 1] } }, { sphere = { radius = 1 } }, \
                    { plane = { size = [1, 1] } } or \
                    { lattice = { cells = [4, 4, 4], spacing = 1, bar = 0.1 } }";

pub(super) fn resolve(cx: &Context, at: &At<file::Shape>) -> Result<Shape> {
    let file::Shape {
        cuboid,
        sphere,
        plane,
        lattice,
    } = &at.value;
    match (cuboid, sphere, plane, lattice) {
        (Some(cuboid), None, None, None) => {
            let size = &cuboid.value.size;
            cx.positive_edges(size, &size.value.0)?;
            Ok(Shape::Box { size: size.value.0 })
        }
        (None, Some(sphere), None, None) => sphere_shape(cx, &sphere.value),
        (None, None, Some(plane), None) => {
            let size = &plane.value.size;
            cx.positive_edges(size, &size.value.0)?;
            Ok(Shape::Plane { size: size.value.0 })
        }
        (None, None, None, Some(lattice)) => lattice_shape(cx, &lattice.value),
        (None, None, None, None) => Err(cx.refuse(at, "no shape is given", HELP)),
        _ => Err(cx.refuse(at, "more than one shape is given", HELP)),
    }
}

/// The key of the (first) shape.
pub(super) fn kind(shape: &file::Shape) -> Option<&'static str> {
    let kinds = [
        (shape.cuboid.is_some(), "box"),
        (shape.sphere.is_some(), "sphere"),
        (shape.plane.is_some(), "plane"),
        (shape.lattice.is_some(), "lattice"),
    ];
    kinds.iter().find(|(said, _)| *said).map(|(_, kind)| *kind)
}

fn sphere_shape(cx: &Context, sphere: &file::Sphere) -> Result<Shape> {
    let subdivisions = sphere.subdivisions.value;
    cx.checked(&sphere.subdivisions, limits::subdivisions(subdivisions))?;
    Ok(Shape::Sphere {
        radius: cx.positive(&sphere.radius, "`radius`")?,
        subdivisions,
    })
}

fn lattice_shape(cx: &Context, lattice: &file::Lattice) -> Result<Shape> {
    let cells = lattice.cells.value;
    cx.checked(&lattice.cells, limits::cells(cells))?;
    let spacing = cx.positive(&lattice.spacing, "`spacing`")?;
    let bar = cx.positive(&lattice.bar, "`bar`")?;
    if bar >= spacing {
        let what = format!(
            "a bar of {} m fills the whole cell of {} m",
            number(bar),
            number(spacing)
        );
        let help = "`bar` is the thickness of the wires, below `spacing`";
        let other = (&lattice.spacing.span, "the cell");
        return Err(cx.report.refuse_two(&lattice.bar.span, other, what, help));
    }
    Ok(Shape::Lattice {
        cells,
        spacing,
        bar,
    })
}
