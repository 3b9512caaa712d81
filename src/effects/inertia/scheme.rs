//! The generalised-alpha method (J. Chung and G. M. Hulbert, "A time integration algorithm for structural dynamics with improved
//! numerical dissipation: the generalized-alpha method", Journal of Applied Mechanics 60, 1993), with its forces weighted:
//! nothing is evaluated between the ends of a step.

/// Constants of the method.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Scheme {
    /// Weight of the accelerations at the start of a step.
    pub alpha_m: f64,
    /// Weight of the forces there.
    pub alpha_f: f64,
    /// Newmark's constants.
    pub beta: f64,
    /// Newmark's weight of the new acceleration in the velocity.
    pub gamma: f64,
}

impl Scheme {
    /// With this spectral radius for frequencies without bound: second order, unconditionally stable for linear bodies, and
    /// with the least damping of what a step resolves.
    pub fn new(rho_inf: f64) -> Self {
        let alpha_m = (2.0 * rho_inf - 1.0) / (rho_inf + 1.0);
        let alpha_f = rho_inf / (rho_inf + 1.0);
        Scheme {
            alpha_m,
            alpha_f,
            beta: 0.25 * (1.0 - alpha_m + alpha_f).powi(2),
            gamma: 0.5 - alpha_m + alpha_f,
        }
    }

    /// Acceleration at the end of a step of size `dt` that moves a point by `du`, from velocity and acceleration at its start.
    #[inline]
    pub fn acceleration(&self, du: f64, [v, a]: [f64; 2], dt: f64) -> f64 {
        (du - dt * v) / (self.beta * dt * dt) - (0.5 - self.beta) / self.beta * a
    }

    /// Velocity there, from the accelerations at both ends.
    #[inline]
    pub fn velocity(&self, [v, a]: [f64; 2], a1: f64, dt: f64) -> f64 {
        v + dt * ((1.0 - self.gamma) * a + self.gamma * a1)
    }

    /// What the inertia in the tangent is of the mass, and what a damping force in proportion to velocity is of itself there.
    pub fn tangent(&self, dt: f64) -> [f64; 2] {
        let inertia = (1.0 - self.alpha_m) / (self.beta * dt * dt);
        let damping = (1.0 - self.alpha_f) * self.gamma / (self.beta * dt);
        [inertia, damping]
    }

    /// Error of the displacement that a step adds, by the difference of its accelerations: that of the expansion of Newmark's
    /// formula (O. C. Zienkiewicz and Y. M. Xie, Earthquake Engineering and Structural Dynamics 20, 1991), with accelerations
    /// that belong to the time `(alpha_m - alpha_f) dt` after the ends of steps.
    pub fn error(&self, dt: f64) -> f64 {
        (self.beta - 1.0 / 6.0 + 0.5 * (self.alpha_m - self.alpha_f)) * dt * dt
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    /// State of `u'' + u + u^3 = 0` from `u = 1` at rest.
    struct Hardening {
        scheme: Scheme,
        u: f64,
        v: f64,
        a: f64,
    }

    impl Hardening {
        fn new(rho: f64) -> Self {
            Hardening {
                scheme: Scheme::new(rho),
                u: 1.0,
                v: 0.0,
                a: -2.0,
            }
        }

        /// A step, by Newton's method on the weighted balance; returns the acceleration before it.
        fn step(&mut self, dt: f64) -> f64 {
            let s = self.scheme;
            let [k_m, _] = s.tangent(dt);
            let force = |u: f64| u + u * u * u;
            let (u0, mut u) = (self.u, self.u + dt * self.v);
            let mut a1 = 0.0;
            for _ in 0..20 {
                a1 = s.acceleration(u - u0, [self.v, self.a], dt);
                let r = (1.0 - s.alpha_m) * a1
                    + s.alpha_m * self.a
                    + (1.0 - s.alpha_f) * force(u)
                    + s.alpha_f * force(u0);
                u -= r / (k_m + (1.0 - s.alpha_f) * (1.0 + 3.0 * u * u));
            }
            let before = self.a;
            self.v = s.velocity([self.v, self.a], a1, dt);
            (self.u, self.a) = (u, a1);
            before
        }
    }

    /// Classical fourth-order Runge-Kutta steps of the same equation, far smaller.
    fn exact(mut y: [f64; 2], time: f64, n: u32) -> f64 {
        let h = time / f64::from(n);
        let f = |[u, v]: [f64; 2]| [v, -u - u * u * u];
        let go = |y: [f64; 2], k: [f64; 2], h: f64| [y[0] + h * k[0], y[1] + h * k[1]];
        for _ in 0..n {
            let k1 = f(y);
            let k2 = f(go(y, k1, 0.5 * h));
            let k3 = f(go(y, k2, 0.5 * h));
            let k4 = f(go(y, k3, h));
            for i in 0..2 {
                y[i] += h / 6.0 * (k1[i] + 2.0 * k2[i] + 2.0 * k3[i] + k4[i]);
            }
        }
        y[0]
    }

    /// Chung and Hulbert 1993: second order for every spectral radius.
    #[test]
    fn errors_fall_with_the_square_of_the_step() {
        let reference = exact([1.0, 0.0], 4.0, 4000);
        for rho in [1.0, 0.8, 0.5, 0.0] {
            let error = |n: u32| {
                let mut motion = Hardening::new(rho);
                for _ in 0..n {
                    motion.step(4.0 / f64::from(n));
                }
                (motion.u - reference).abs()
            };
            let order = (error(200) / error(400)).log2();
            assert!((order - 2.0).abs() < 0.1, "rho {rho}: order {order}");
        }
    }

    /// Chung and Hulbert 1993: what is left of fast vibrations is what was asked for. The largest eigenvalue of a
    /// step, by its powers.
    #[test]
    fn fast_vibrations_are_damped_as_asked() {
        for rho in [1.0, 0.8, 0.5, 0.2] {
            let s = Scheme::new(rho);
            // Stiffness times the square of the step, beside which the mass is nothing.
            let k = 1e10;
            let step = |[u, v, a]: [f64; 3]| {
                let right = (1.0 - s.alpha_m) / s.beta * (u + v)
                    + ((1.0 - s.alpha_m) * (0.5 - s.beta) / s.beta - s.alpha_m) * a
                    - s.alpha_f * k * u;
                let u1 = right / ((1.0 - s.alpha_m) / s.beta + (1.0 - s.alpha_f) * k);
                let a1 = s.acceleration(u1 - u, [v, a], 1.0);
                [u1, s.velocity([v, a], a1, 1.0), a1]
            };
            let size = |y: &[f64; 3]| k.sqrt() * y[0].abs() + y[1].abs() + y[2].abs() / k.sqrt();
            let mut y = [1.0, 1.0, 1.0];
            (0..50).for_each(|_| y = step(y));
            let first = size(&y);
            (0..400).for_each(|_| y = step(y));
            let radius = (size(&y) / first).powf(1.0 / 400.0);
            assert!((radius - rho).abs() < 0.02, "rho {rho}: {radius}");
        }
    }

    /// The estimate against the true error of every step of a running solution.
    #[test]
    fn the_local_error_is_that_of_a_step() {
        for rho in [1.0, 0.8, 0.5] {
            let (mut motion, dt) = (Hardening::new(rho), 0.02);
            let (mut product, mut square) = (0.0, 0.0);
            for k in 0..100 {
                let start = [motion.u, motion.v];
                let before = motion.step(dt);
                let error = motion.u - exact(start, dt, 20);
                let told = motion.scheme.error(dt) * (motion.a - before);
                // The first steps have accelerations that are not those of the method yet.
                if k >= 20 {
                    product += error * told;
                    square += told * told;
                }
            }
            let ratio = product / square;
            assert!((ratio - 1.0).abs() < 0.02, "rho {rho}: {ratio}");
        }
    }
}
