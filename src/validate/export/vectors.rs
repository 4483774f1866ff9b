//! Test vectors: vertices of a scene, and where they are seen, for unit tests in any language.
//!
//! For each object a few vertices, spread over its list: the vertex p in the object's frame, the emission event E in the world, the film
//! point, and W, by the formulas of the bundle's page. Each object also has the tolerance for a program that follows the same formulas in
//! single precision with all of the bundle's numbers rounded to it: four times the largest error of such runs over the object's vertices,
//! which add up products in three orders (others may double it, with a factor of two to spare), and at least four steps of single precision
//! of the largest number. κ is (−1, d) with d of length 1: κ = k/|k_ct|, which is the same in real numbers, has the rounding error of k_ct,
//! too, and is several times less accurate for fast objects. Vertices behind the camera have no film point.

use serde::Serialize;

use super::bundle::{CameraEntry, FourVector, Matrix, ObjectEntry};
use crate::approximate::projection::Observer;
use crate::camera::Camera;
use crate::error::Result;
use crate::mesh::Mesh;
use crate::scene::model::Scene;
use crate::spacetime::{InertialFrame, Rest};

/// The value of [`Vectors::format`].
pub const VECTORS_FORMAT: &str = "nullray-vectors";
/// The largest number of vertices per object.
const MOST: usize = 32;
/// A step of single precision, relative.
const STEP: f64 = f32::EPSILON as f64;
/// The ratio of the tolerance to the error of a run in single precision; see the [module](self).
const MARGIN: f64 = 4.0;
/// The orders in which products are added up: components of (ct, x, y, z).
const ORDERS: [[usize; 4]; 3] = [[0, 1, 2, 3], [3, 2, 1, 0], [1, 2, 3, 0]];

/// Test vectors of a scene.
#[derive(Debug, Clone, Serialize)]
#[non_exhaustive]
pub struct Vectors {
    /// Always "nullray-vectors".
    pub format: &'static str,
    /// The version of the format.
    pub version: u32,
    /// The objects, in the order of the bundle.
    pub objects: Vec<ObjectVectors>,
}

/// Test vectors of an object.
#[derive(Debug, Clone, Serialize)]
#[non_exhaustive]
pub struct ObjectVectors {
    /// Its name.
    pub object: String,
    /// The tolerance for a program in single precision.
    pub tolerance_single: Tolerances,
    /// Its vertices.
    pub vectors: Vec<Vector>,
}

/// Allowed errors, absolute.
#[derive(Debug, Clone, Copy, Default, Serialize)]
#[non_exhaustive]
pub struct Tolerances {
    /// Of each coordinate of the event, metres.
    pub event: f64,
    /// Of the film point along each axis, pixels.
    pub film: f64,
    /// Of W.
    pub wavelength_ratio: f64,
}

/// A vertex and how it is seen.
#[derive(Debug, Clone, Serialize)]
#[non_exhaustive]
pub struct Vector {
    /// Its index in the object.
    pub vertex: usize,
    /// p: its position in the object's frame, metres.
    pub position: [f64; 3],
    /// E: the event in the world in which it is seen, (ct, x, y, z), metres.
    pub event: FourVector,
    /// The film point, pixels from the top left corner; null behind the camera.
    pub film: Option<[f64; 2]>,
    /// W = observed / emitted wavelength.
    pub wavelength_ratio: f64,
}

/// The test vectors of object `index` of `scene`, whose vertices are those of `mesh`.
///
/// # Errors
/// As [`Observer::of`] and [`Observer::projection`].
pub(super) fn of_object(
    scene: &Scene,
    camera: &Camera,
    index: usize,
    mesh: &Mesh,
    entries: (&CameraEntry, &ObjectEntry),
) -> Result<ObjectVectors> {
    let object = &scene.objects[index];
    let ray_index = match scene.effects.retardation {
        true => scene.medium_index,
        false => 0.0,
    };
    let observer = Observer::of(camera, ray_index)?;
    let frame = InertialFrame::<Rest>::new(object.velocity, object.origin);
    let projection = observer.projection(&frame)?;
    let count = mesh.positions.len();
    // Evenly spread over all vertices.
    let chosen = (0..MOST.min(count)).map(|n| n * count / MOST.min(count));
    let vectors: Vec<Vector> = chosen
        .filter_map(|vertex| {
            let p = mesh.positions[vertex];
            let image = projection.image(p)?;
            let (since, _) = projection.emission(image.d, image.s);
            let event = camera.shot.event + since;
            Some(Vector {
                vertex,
                position: p.to_array(),
                event: event.to_array(),
                film: image.film_point(),
                wavelength_ratio: projection.wavelength_ratio(image.d),
            })
        })
        .collect();
    Ok(ObjectVectors {
        object: object.name.clone(),
        tolerance_single: tolerances(&vectors, ray_index, entries),
        vectors,
    })
}

/// The tolerance of single precision; see the [module](self).
fn tolerances(
    vectors: &[Vector],
    index: f64,
    (camera, object): (&CameraEntry, &ObjectEntry),
) -> Tolerances {
    let runs = ORDERS.map(|order| Single::new(camera, object, index, order));
    let mut most = Tolerances::default();
    let mut size = Tolerances::default();
    let raise = |value: &mut f64, to: f64| *value = value.max(to);
    let all = vectors
        .iter()
        .flat_map(|vector| runs.each_ref().map(|run| (vector, run)));
    for (vector, run) in all {
        let (event, film, ratio) = run.seen(vector.position);
        for (a, b) in vector.event.iter().zip(event) {
            raise(&mut most.event, (a - f64::from(b)).abs());
            raise(&mut size.event, a.abs());
        }
        for (a, b) in vector.film.iter().flatten().zip(film.iter().flatten()) {
            // Far outside the picture, film points of vertices beside the camera mean little.
            raise(&mut most.film, (a - f64::from(*b)).abs());
            raise(&mut size.film, a.abs());
        }
        raise(
            &mut most.wavelength_ratio,
            (vector.wavelength_ratio - f64::from(ratio)).abs(),
        );
        raise(&mut size.wavelength_ratio, vector.wavelength_ratio);
    }
    let of = |most: f64, size: f64| MARGIN * most.max(STEP * size);
    Tolerances {
        event: of(most.event, size.event),
        film: of(most.film, size.film),
        wavelength_ratio: of(most.wavelength_ratio, size.wavelength_ratio),
    }
}

/// The vertex transform of the bundle's page in single precision.
struct Single {
    object: [[f32; 4]; 4],
    camera: [[f32; 4]; 4],
    /// q: the position of the shot in the object's frame.
    place: [f32; 3],
    /// P − O.
    offset: [f32; 4],
    shot: [f32; 4],
    axes: [[f32; 3]; 3],
    tangents: [f32; 2],
    size: [f32; 2],
    index: f32,
    order: [usize; 4],
}

impl Single {
    fn new(camera: &CameraEntry, object: &ObjectEntry, index: f64, order: [usize; 4]) -> Single {
        let matrix = |m: &Matrix| m.map(|row| row.map(|x| x as f32));
        let offset = [0, 1, 2, 3].map(|i| (camera.shot_event[i] - object.origin[i]) as f32);
        let axes = [camera.right, camera.up, camera.forward];
        let difference: FourVector = [0, 1, 2, 3].map(|i| camera.shot_event[i] - object.origin[i]);
        let place = [1, 2, 3].map(|i| inverse_row(&object.world_from_object, i, difference) as f32);
        Single {
            place,
            object: matrix(&object.world_from_object),
            camera: matrix(&camera.world_from_camera),
            offset,
            shot: camera.shot_event.map(|x| x as f32),
            axes: axes.map(|axis| axis.map(|x| x as f32)),
            tangents: camera.tan_half_fov.unwrap_or([1.0; 2]).map(|x| x as f32),
            size: camera.size.map(|n| n as f32),
            index: index as f32,
            order,
        }
    }

    /// Event, film point and W of the vertex `p`: as the page says, relative to the shot.
    fn seen(&self, p: [f64; 3]) -> ([f32; 4], Option<[f32; 2]>, f32) {
        let p = p.map(|x| x as f32);
        let u = self.object.map(|row| row[0]);
        let k = match self.index == 1.0 {
            true => {
                // In vacuum: the null vector (−|r|, r) of the rest frame, taken to the world.
                let r: [f32; 3] = std::array::from_fn(|i| p[i] - self.place[i]);
                let r = [0.0, r[0], r[1], r[2]];
                self.product(&self.object, [-self.dot(r, r).sqrt(), r[1], r[2], r[3]])
            }
            false => self.in_medium(p, u),
        };
        let event = std::array::from_fn(|i| self.shot[i] + k[i]);
        let way = [0.0, k[1], k[2], k[3]];
        let length = self.dot(way, way).sqrt();
        let kappa = [-1.0, k[1] / length, k[2] / length, k[3] / length];
        // Into the camera's frame, and along its axes.
        let seen = self.product(&inverse(&self.camera), kappa);
        let along = self.axes.map(|a| self.dot([0.0, a[0], a[1], a[2]], seen));
        let film = (along[2] > 0.0).then(|| {
            [
                0.5 * self.size[0] * (1.0 + along[0] / along[2] / self.tangents[0]),
                0.5 * self.size[1] * (1.0 - along[1] / along[2] / self.tangents[1]),
            ]
        });
        // W is the quotient of κ·u for the object and for the camera.
        let dot = |v: [f32; 4]| self.dot(kappa, [-v[0], v[1], v[2], v[3]]);
        (event, film, dot(u) / dot(self.camera.map(|row| row[0])))
    }

    /// Σ a_i b_i.
    fn dot(&self, a: [f32; 4], b: [f32; 4]) -> f32 {
        self.order.iter().map(|i| a[*i] * b[*i]).sum()
    }

    fn product(&self, m: &[[f32; 4]; 4], v: [f32; 4]) -> [f32; 4] {
        m.map(|row| self.dot(row, v))
    }

    /// The displacement from the shot at which the vertex is seen in a medium: on its world line b + τ u.
    fn in_medium(&self, p: [f32; 3], u: [f32; 4]) -> [f32; 4] {
        let at_zero = self.product(&self.object, [0.0, p[0], p[1], p[2]]);
        let b: [f32; 4] = std::array::from_fn(|i| at_zero[i] - self.offset[i]);
        // η² |X|² = ct² of (ct, X) = b + τ u: the earlier solution.
        let n = self.index * self.index;
        let form =
            |a: [f32; 4], b: [f32; 4]| n * (a[1] * b[1] + a[2] * b[2] + a[3] * b[3]) - a[0] * b[0];
        let (q, h, r) = (form(u, u), form(u, b), form(b, b));
        let root = (h * h - q * r).max(0.0).sqrt();
        let tau = match n == 0.0 {
            true => -b[0] / u[0],
            false => (-h + root) / q,
        };
        std::array::from_fn(|i| b[i] + tau * u[i])
    }
}

/// Row `i` of M⁻¹ = G Mᵀ G, times `v`.
fn inverse_row(m: &Matrix, i: usize, v: FourVector) -> f64 {
    m[1][i] * v[1] + m[2][i] * v[2] + m[3][i] * v[3] - m[0][i] * v[0]
}

/// M⁻¹ = G Mᵀ G, G = diag(−1, 1, 1, 1).
fn inverse(m: &[[f32; 4]; 4]) -> [[f32; 4]; 4] {
    let sign = |i: usize| if i == 0 { -1.0 } else { 1.0 };
    std::array::from_fn(|i| std::array::from_fn(|j| sign(i) * m[j][i] * sign(j)))
}

/// Whether the film points of `camera` are those of the page's formulas.
pub(super) fn fits(camera: &CameraEntry) -> bool {
    camera.is_point && camera.tan_half_fov.is_some()
}
