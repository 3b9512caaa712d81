//! Deformable bodies: materials, elements, where meshes come from, sets.
use super::mesh::*;
use super::mesh_file::MeshFile;
use super::surface::Placement;
use schemars::JsonSchema;
use serde::{Deserialize, Serialize};
use std::collections::BTreeMap;

/// Constitutive law, written `{"st_venant_kirchhoff": {"E": 210000, "nu": 0.3}}`.
#[derive(Debug, Clone, Copy, PartialEq, Serialize, Deserialize, JsonSchema)]
#[serde(rename_all = "snake_case")]
pub enum Material {
    /// Linear law between Green-Lagrange strain and second Piola-Kirchhoff stress: large rotations, small strains.
    StVenantKirchhoff(Elastic),
    /// Compressible neo-Hooke: large strains.
    NeoHooke(Elastic),
}

/// Young's modulus (force / length^2) and Poisson's ratio.
#[derive(Debug, Clone, Copy, PartialEq, Serialize, Deserialize, JsonSchema)]
#[serde(deny_unknown_fields)]
pub struct Elastic {
    #[serde(rename = "E")]
    pub e: f64,
    pub nu: f64,
}

/// A deformable body.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize, JsonSchema)]
#[serde(deny_unknown_fields)]
pub struct Body {
    pub mesh: MeshSource,
    /// Name of the material.
    pub material: String,
    #[serde(default)]
    pub element: Element,
    /// Where the mesh is put: first scaled, then rotated about the origin, then moved.
    #[serde(default)]
    pub placement: Placement,
    /// Further node and face sets, selected by geometry, where the mesh is put.
    #[serde(default)]
    pub sets: BTreeMap<String, Selection>,
}

/// Element formulation.
#[derive(Debug, Clone, Copy, Default, PartialEq, Serialize, Deserialize, JsonSchema)]
#[serde(rename_all = "snake_case")]
pub enum Element {
    /// 8-node solid-shell: assumed transverse shear and thickness strains, seven enhanced strains.
    #[default]
    H8,
    /// 8-node brick without assumed or enhanced strains (locks when thin; for solids and comparisons).
    H8Displacement,
    /// 18-node solid-shell, quadratic in its plane and linear through the thickness: assumed membrane, transverse shear and
    /// thickness strains, four enhanced strains. Curved meshes follow cylinders and spheres closely.
    Q18,
}

/// Where a body's mesh comes from.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize, JsonSchema)]
#[serde(rename_all = "snake_case")]
pub enum MeshSource {
    /// Flat plate; the thickness is along z.
    Plate(Plate),
    /// Part of a cylinder about the y axis; the thickness is radial.
    CylinderPanel(CylinderPanel),
    /// Part of a sphere about the origin; the thickness is radial.
    SpherePanel(SpherePanel),
    /// Box of elements with grading along each axis; layers along z.
    Block(Block),
    /// Mesh file of hexahedra, or of a surface that `thickness` makes a body of: gmsh, Abaqus and CalculiX, Nastran, VTK,
    /// STL.
    File(MeshFile),
}

/// Set selected by geometry, on the undeformed mesh.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize, JsonSchema)]
#[serde(rename_all = "snake_case", deny_unknown_fields)]
pub enum Selection {
    /// Nodes inside a box (its borders included).
    NodesInBox { min: [f64; 3], max: [f64; 3] },
    /// Nodes within `tolerance` of a plane.
    NodesNearPlane {
        point: [f64; 3],
        normal: [f64; 3],
        tolerance: f64,
    },
    /// Nodes within `tolerance` of a point.
    NodesNearPoint { point: [f64; 3], tolerance: f64 },
    /// Outer faces whose nodes all lie inside a box.
    FacesInBox { min: [f64; 3], max: [f64; 3] },
    /// Outer faces whose outward normal is within `angle` degrees of `normal`.
    FacesFacing { normal: [f64; 3], angle: f64 },
}
