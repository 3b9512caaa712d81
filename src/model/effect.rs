//! The effects that the program has: their names and what each means. This table is the only list of them, so that no effect
//! can be added without words.

/// Makes the enum and its tables from one line for each effect.
macro_rules! effects {
    ($($kind:ident, $name:literal, $listed:ident: $meaning:literal;)*) => {
        /// An effect that the program has.
        #[derive(Debug, Clone, Copy, PartialEq, Eq)]
        pub enum EffectKind {
            $(#[doc = $meaning] $kind,)*
        }

        impl EffectKind {
            /// Every effect, those of contact pairs in the order in which plans tell them.
            pub const ALL: &'static [EffectKind] = &[$(EffectKind::$kind,)*];

            /// The name in plans; that of a part begins with the name of the whole.
            pub const fn name(self) -> &'static str {
                match self {
                    $(EffectKind::$kind => $name,)*
                }
            }

            /// What it means, in plain words.
            pub const fn meaning(self) -> &'static str {
                match self {
                    $(EffectKind::$kind => $meaning,)*
                }
            }

            /// Whether it is a detail, which the list of effects that are on (`Plan::names`) leaves out.
            pub const fn is_detail(self) -> bool {
                match self {
                    $(EffectKind::$kind => effects!(@$listed),)*
                }
            }
        }
    };
    (@listed) => { false };
    (@detail) => { true };
}

effects! {
    LargeRotation, "large_rotation", listed: "displacements and rotations of any size";
    SmallDisplacements, "small_displacements", listed:
        "linear elements, and contact linearised where it starts: for displacements that stay small";
    H8SolidShell, "element.h8_solid_shell", listed: "8-node solid-shell elements that do not lock when thin";
    H8Displacement, "element.h8_displacement", listed: "plain 8-node bricks, for solids (they lock when thin)";
    H8MeanDilatation, "element.h8_mean_dilatation", listed: "8-node bricks with one change of volume each, for solids of rubber";
    H8Eas3, "element.h8_eas3", listed: "8-node solid-shell elements enhanced through their thickness only";
    Q18SolidShell, "element.q18_solid_shell", listed: "18-node quadratic solid-shells, for thin and curved sheets";
    NurbsShell, "element.nurbs_shell", listed: "a CAD surface as a thin shell: its control points are the unknowns";
    NurbsSeams, "element.nurbs_seams", listed: "faces of a CAD surface joined along their edges, whose knots need not match";
    AssumedStrains, "element.assumed_strains", detail: "strains interpolated so that thin elements do not lock";
    EnhancedStrains, "element.enhanced_strains", detail: "further strains inside an element, condensed";
    StVenantKirchhoff, "material.st_venant_kirchhoff", listed: "linear stress-strain law for small strains";
    NeoHooke, "material.neo_hooke", listed: "rubber-like law for large strains";
    Hencky, "material.hencky", listed: "linear law in logarithmic strains, for moderately large strains";
    J2, "material.j2", listed: "metal that yields and hardens (von Mises), for forming and springback";
    Hill48, "material.hill48", listed: "rolled metal that yields and narrows by its direction (Hill 1948)";
    ArmstrongFrederick, "material.armstrong_frederick", listed:
        "metal whose yield surface moves with its flow (Armstrong and Frederick), for cyclic loads";
    DrivenByForce, "surface.driven_by_force", listed: "components of a surface's motion are unknowns with given forces";
    SurfaceMotion, "surface.motion", detail: "rigid surfaces move as prescribed";
    MidSurface, "support.mid_surface", listed: "supports on the mean of both faces of a shell";
    DeadLoad, "load.dead", listed: "loads of constant direction";
    FollowerPressure, "load.follower_pressure", listed: "pressures that follow the deformed faces";
    Stages, "stages", listed: "parts of the run with contacts, supports and ways of tools of their own, and release";
    Viscous, "stabilization.viscous", listed: "a small viscous force holds bodies until contact does";
    Inertia, "dynamics.inertia", listed: "bodies have inertia: they move, vibrate and rebound";
    MassDamping, "dynamics.damping", listed: "forces against the velocity, in proportion to the mass";
    Viscosity, "dynamics.viscosity", listed: "viscous stresses against the rate of strain (Kelvin-Voigt)";
    UnsymmetricSystem, "system.unsymmetric", listed: "unsymmetric tangent matrix, factorized by LU";
    EnergyWatch, "energy.watch", detail: "work and energies are balanced at every step";
    OutputFields, "output.fields", detail: "displacements, stresses and contact fields are written";
    OutputContactPoints, "output.contact_points", detail: "gaps, tractions and slip are written for every slave point";
    OutputShellStresses, "output.shell_stresses", detail: "stresses of shells at bottom, middle and top are written";
    NormalPenalty, "contact.normal.penalty", listed: "contact pressure = penalty times penetration";
    MasterRigid, "contact.master.rigid", listed: "rigid surfaces";
    MasterDeformable, "contact.master.deformable", listed: "faces of bodies that deform";
    MasterSmooth, "contact.master.smooth", listed: "one smooth surface through the nodes of the faces";
    SelfContact, "contact.self", listed: "faces of a body touch faces of the same body";
    FacetsBilinear, "contact.master.rigid.facets.bilinear", listed: "plane or twisted facets for a rigid surface";
    FacetsBiquadratic, "contact.master.rigid.facets.biquadratic", listed: "curved facets for a rigid surface";
    FacetsSmooth, "contact.master.rigid.facets.smooth", listed: "one smooth surface over the facets of a rigid surface";
    MasterTrimmed, "contact.master.rigid.trimmed", detail: "patches of a rigid surface end at trimming curves";
    PointsNodes, "contact.points.nodes", listed: "contact is sampled at nodes";
    PointsGauss, "contact.points.gauss", listed: "contact is sampled at Gauss points of the faces";
    PointsLobatto, "contact.points.lobatto", listed: "contact is sampled at Lobatto points of the faces";
    PointsSegments, "contact.points.segments", listed: "contact is integrated over faces cut by those they meet";
    AveragedGap, "contact.gap.averaged", listed: "gaps averaged over the faces around slave nodes";
    TwoHalfPasses, "contact.passes.two_half", listed: "each side of a contact is the slave once, no side preferred";
    EdgePass, "contact.passes.edges", listed: "sharp edges of the master are slaves as well";
    TangentExact, "contact.tangent.exact", listed: "tangent matrix exact at every penetration";
    TangentPublished, "contact.tangent.published", listed: "tangent matrix of the published form";
    TangentMain, "contact.tangent.main", detail: "main part of the tangent: stiffness along the normal";
    TangentRotational, "contact.tangent.rotational", detail: "rotational part of the tangent: the master turns";
    TangentCurvature, "contact.tangent.curvature", detail: "curvature part of the tangent: the normal turns along the master";
    TangentEdges, "contact.tangent.edges", detail: "tangent on edges and corners, where the traction acts along the distance";
    Coulomb, "contact.friction.coulomb", listed: "friction: at most `mu` times the pressure (Coulomb)";
    Orthotropic, "contact.friction.orthotropic", listed:
        "friction with two coefficients, along a direction of the master and across it";
    ShearLimited, "contact.friction.shear_limited", listed: "friction: at most `mu` times the pressure, and at most a limit";
    Augmentation, "contact.augmentation", listed: "multipliers beside the penalties, until gaps have vanished";
    Offset, "contact.offset", listed: "contact begins at a distance from the master";
    OverclosureStressFree, "contact.overclosure.stress_free", detail: "what overlaps at the start counts as touching";
    OverclosureShrink, "contact.overclosure.shrink", detail: "what overlaps at the start is resolved over a time";
    OverclosureCurved, "contact.overclosure.curved", detail: "gaps are those between the curved surfaces that flat facets stand for";
}

impl EffectKind {
    /// The effect of this name.
    pub fn named(name: &str) -> Option<EffectKind> {
        (Self::ALL.iter().copied()).find(|kind| kind.name() == name)
    }

    /// Whether it is one of a contact pair.
    pub(crate) fn of_pairs(self) -> bool {
        self.name().starts_with("contact.")
    }
}
