//! Points, directions and placements.

use super::entity::{Entity, Told};
use super::exchange::Exchange;
use crate::Vec3;
use nalgebra::{Matrix3, SVector};

/// Right-handed unit vectors at an origin.
#[derive(Debug, Clone, Copy)]
pub struct Frame {
    pub origin: Vec3,
    pub axes: [Vec3; 3],
}

/// `x -> linear x + shift`.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Placement {
    pub linear: Matrix3<f64>,
    pub shift: Vec3,
}

impl Placement {
    pub fn identity() -> Self {
        Self {
            linear: Matrix3::identity(),
            shift: Vec3::zeros(),
        }
    }

    pub fn scaling(factor: f64) -> Self {
        Self {
            linear: Matrix3::identity() * factor,
            shift: Vec3::zeros(),
        }
    }

    pub fn apply(&self, x: Vec3) -> Vec3 {
        self.linear * x + self.shift
    }

    /// First `inner`, then `self`.
    pub fn after(&self, inner: &Self) -> Self {
        Self {
            linear: self.linear * inner.linear,
            shift: self.apply(inner.shift),
        }
    }

    pub fn inverse(&self) -> Option<Self> {
        let linear = self.linear.try_inverse()?;
        Some(Self {
            linear,
            shift: -(linear * self.shift),
        })
    }

    /// Its numbers as bits, to tell copies apart.
    pub fn bits(&self) -> [u64; 12] {
        let mut bits = [0; 12];
        for (bit, x) in bits
            .iter_mut()
            .zip(self.linear.iter().chain(self.shift.iter()))
        {
            *bit = x.to_bits();
        }
        bits
    }

    /// Whether the placement mirrors.
    pub fn mirrors(&self) -> bool {
        self.linear.determinant() < 0.0
    }
}

impl Frame {
    /// From coordinates in the frame to those of the space in which it is given.
    pub fn placement(&self) -> Placement {
        Placement {
            linear: Matrix3::from_columns(&self.axes),
            shift: self.origin,
        }
    }
}

/// A point (CARTESIAN_POINT) of `D` coordinates.
pub fn point<const D: usize>(exchange: &Exchange, index: u32) -> Told<SVector<f64, D>> {
    let entity = Entity::read(exchange, index)?;
    coordinates(&entity, "CARTESIAN_POINT")
}

fn coordinates<const D: usize>(entity: &Entity, kind: &str) -> Told<SVector<f64, D>> {
    let item = entity.attribute(kind, 0, "coordinates")?;
    let x = entity.numbers(item, "a coordinate")?;
    if x.len() != D {
        return Err(entity.wrong(item, &format!("{D} coordinates")));
    }
    Ok(SVector::from_fn(|i, _| x[i]))
}

/// The points in a list.
pub fn points<const D: usize>(exchange: &Exchange, list: &[u32]) -> Told<Vec<SVector<f64, D>>> {
    list.iter().map(|&index| point(exchange, index)).collect()
}

/// A direction (DIRECTION) as a unit vector.
pub fn direction<const D: usize>(exchange: &Exchange, index: u32) -> Told<SVector<f64, D>> {
    let entity = Entity::read(exchange, index)?;
    let x: SVector<f64, D> = coordinates(&entity, "DIRECTION")?;
    let size = x.amax();
    if size > 0.0 && size.is_finite() {
        Ok((x / size).normalize())
    } else {
        Err(format!("{} is zero", entity.describe()))
    }
}

/// A vector (VECTOR): its direction times its magnitude.
pub fn vector<const D: usize>(exchange: &Exchange, index: u32) -> Told<SVector<f64, D>> {
    let entity = Entity::read(exchange, index)?;
    let along = entity.reference("VECTOR", 0, "the direction of a vector")?;
    let size = entity.real("VECTOR", 1, "the magnitude of a vector")?;
    if size == 0.0 {
        return Err(format!("{} has no length", entity.describe()));
    }
    Ok(direction::<D>(exchange, along)? * size)
}

/// An attribute that may be omitted.
fn optional(entity: &Entity, kind: &str, k: usize, what: &str) -> Told<Option<u32>> {
    let item = entity.attribute(kind, k, what)?;
    match item.value {
        super::scan::Value::Omitted => Ok(None),
        _ => entity.target(item, what).map(Some),
    }
}

/// Location and axis of an AXIS1_PLACEMENT.
pub fn axis(exchange: &Exchange, index: u32) -> Told<(Vec3, Vec3)> {
    let entity = Entity::read(exchange, index)?;
    let origin = entity.reference("PLACEMENT", 0, "the location of a placement")?;
    let along = optional(&entity, "AXIS1_PLACEMENT", 0, "the axis of a placement")?;
    let along = along.map(|index| direction(exchange, index)).transpose()?;
    Ok((point(exchange, origin)?, along.unwrap_or_else(Vec3::z)))
}

/// The frame that an AXIS2_PLACEMENT_3D gives.
pub fn frame(exchange: &Exchange, index: u32) -> Told<Frame> {
    let entity = Entity::read(exchange, index)?;
    let kind = "AXIS2_PLACEMENT_3D";
    let origin = entity.reference("PLACEMENT", 0, "the location of a placement")?;
    let axis = optional(&entity, kind, 0, "the axis of a placement")?;
    let across = optional(&entity, kind, 1, "the reference direction of a placement")?;
    let axis = axis
        .map(|index| direction::<3>(exchange, index))
        .transpose()?;
    let across = across
        .map(|index| direction::<3>(exchange, index))
        .transpose()?;
    Ok(Frame {
        origin: point(exchange, origin)?,
        axes: triad(axis.unwrap_or_else(Vec3::z), across),
    })
}

/// Right-handed unit vectors of which the third is `axis` and the first lies in the plane of `axis` and `across`; x, or y
/// where that is parallel to the axis, stands for a reference that is missing or parallel (ISO 10303-42, first_proj_axis).
pub fn triad(axis: Vec3, across: Option<Vec3>) -> [Vec3; 3] {
    let project = |v: Vec3| v - axis * axis.dot(&v);
    let e1 = [across, Some(Vec3::x()), Some(Vec3::y())]
        .into_iter()
        .flatten()
        .map(project)
        .find(|v| v.norm() > 1e-6)
        .unwrap_or_else(|| project(Vec3::z()))
        .normalize();
    [e1, axis.cross(&e1), axis]
}

/// Origin and axes of an AXIS2_PLACEMENT_2D.
pub fn plane_frame(
    exchange: &Exchange,
    index: u32,
) -> Told<(SVector<f64, 2>, [SVector<f64, 2>; 2])> {
    let entity = Entity::read(exchange, index)?;
    let origin = entity.reference("PLACEMENT", 0, "the location of a placement")?;
    let what = "the reference direction of a placement";
    let along = optional(&entity, "AXIS2_PLACEMENT_2D", 0, what)?;
    let along = along.map(|index| direction(exchange, index)).transpose()?;
    let x = along.unwrap_or_else(|| SVector::<f64, 2>::new(1.0, 0.0));
    Ok((
        point(exchange, origin)?,
        [x, SVector::<f64, 2>::new(-x.y, x.x)],
    ))
}

/// What maps one representation into another: a placement, or an operator that may scale and mirror.
pub fn transformation(exchange: &Exchange, index: u32) -> Told<Placement> {
    let entity = Entity::read(exchange, index)?;
    if entity.is("AXIS2_PLACEMENT_3D") {
        return Ok(frame(exchange, index)?.placement());
    }
    if entity.is("CARTESIAN_TRANSFORMATION_OPERATOR_3D") {
        return operator(&entity);
    }
    Err(format!(
        "{} is no placement that is read",
        entity.describe()
    ))
}

/// A CARTESIAN_TRANSFORMATION_OPERATOR_3D: the last five attributes are axis1, axis2, origin, scale and axis3. (How many
/// texts stand in front of them differs between the editions.)
fn operator(entity: &Entity) -> Told<Placement> {
    use super::scan::Value;
    let exchange = entity.exchange;
    let items = entity.operator_values()?;
    let [axis1, axis2, origin, scale, axis3] = items;
    let read = |item: &super::scan::Item| match item.value {
        Value::Omitted => Ok(None),
        _ => direction::<3>(exchange, entity.target(item, "an axis")?).map(Some),
    };
    let (first, second, third) = (read(axis1)?, read(axis2)?, read(axis3)?);
    let axis = third.unwrap_or_else(|| match (first, second) {
        (Some(x), Some(y)) if x.cross(&y).norm() > 1e-9 => x.cross(&y).normalize(),
        _ => Vec3::z(),
    });
    let [e1, mut e2, e3] = triad(axis, first);
    // The second axis decides on which side it lies, so that the operator may mirror.
    if second.is_some_and(|y| y.dot(&e2) < 0.0) {
        e2 = -e2;
    }
    let factor = match scale.value {
        Value::Omitted => 1.0,
        _ => entity.number(scale, "the scale of a transformation")?,
    };
    if factor.is_nan() || factor <= 0.0 {
        return Err(entity.wrong(scale, "a positive scale of a transformation"));
    }
    let origin = point::<3>(
        exchange,
        entity.target(origin, "the origin of a transformation")?,
    )?;
    Ok(Placement {
        linear: Matrix3::from_columns(&[e1, e2, e3]) * factor,
        shift: origin,
    })
}
