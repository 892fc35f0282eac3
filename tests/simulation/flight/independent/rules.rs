//! Events of the block and their effects: the rules of docs/unit/model.md.

use rocking_block::block::Body;

use super::{BOTH, IndependentEvent, Kind, Rule, Run, State};

/// A function that is positive until an event.
#[derive(Clone, Copy, Debug, PartialEq)]
enum Watched {
    Reaction(usize),
    Gap(usize),
    /// The held corner would lift.
    Held(usize),
    /// In full contact the held corner would not lift.
    Unloaded(usize),
    /// The sliding corner would be under pressure if it gripped.
    Slide,
}

impl Run<'_> {
    /// Advances to a time, step by step, and applies the first event of each step.
    pub fn advance(&mut self, until: f64) {
        let Body { omega_v, xi_v, p, .. } = self.block.body;
        let longest =
            0.1 / omega_v.max(p).max(2.0 * xi_v * omega_v).max(if xi_v > 0.0 { 0.5 * omega_v / xi_v } else { 0.0 });
        while self.time < until {
            let remaining = until - self.time;
            let size = remaining / (remaining / longest).ceil();
            let end = self.step(size);
            let falls =
                self.watched().into_iter().filter_map(|watched| Some((self.fall(watched, size, &end)?, watched)));
            match falls.min_by(|a, b| a.0.total_cmp(&b.0)) {
                Some((elapsed, watched)) => {
                    self.state = self.step(elapsed);
                    self.time += elapsed;
                    self.apply(watched);
                }
                None => {
                    self.state = end;
                    self.time = if size == remaining { until } else { self.time + size };
                    // Touching corners move with their supports.
                    for i in BOTH.into_iter().filter(|&i| self.touching[i] && self.held != Some(i)) {
                        self.state[6 + i] = self.height(&self.state, i)[0];
                    }
                }
            }
        }
    }

    fn watched(&self) -> Vec<Watched> {
        let of = |i: usize| match (self.touching[i], self.held == Some(i)) {
            (true, true) => Watched::Held(i),
            (true, false) => Watched::Reaction(i),
            (false, _) => Watched::Gap(i),
        };
        let slides = self.foot.is_none() && self.touching != [false; 2];
        let held = self.held.map(Watched::Unloaded);
        BOTH.map(of).into_iter().chain(slides.then_some(Watched::Slide)).chain(held).collect()
    }

    fn value(&self, watched: Watched, time: f64, state: &State) -> f64 {
        match watched {
            Watched::Reaction(i) => self.support(self.height(state, i)),
            Watched::Gap(i) => self.gap(state, i),
            Watched::Held(i) => -self.opening(time, state, i, self.top_rate(state, i)),
            Watched::Unloaded(i) => {
                let forces = self.forces(time, state, [true; 2], true);
                self.corner_acceleration(state, &forces, i) - self.top_acceleration(self.top_rate(state, i))
            }
            Watched::Slide => -self.pressure(state),
        }
    }

    /// Round-off around zero: 1e-13 of the magnitude of the terms.
    fn rounding(&self, watched: Watched) -> f64 {
        match watched {
            Watched::Gap(_) => 1e-13 * self.block.static_deflection().max(self.block.b),
            Watched::Reaction(_) | Watched::Held(_) | Watched::Unloaded(_) | Watched::Slide => {
                1e-13 * self.block.gravity
            }
        }
    }

    /// Returns the time in a step (s after its start) at which a watched function falls through zero. A function that starts at
    /// zero must rise first, if only briefly.
    fn fall(&self, watched: Watched, size: f64, end: &State) -> Option<f64> {
        let rounding = self.rounding(watched);
        let after = |elapsed: f64| self.value(watched, self.time + elapsed, &self.step(elapsed));
        let start = self.value(watched, self.time, &self.state);
        let (mut low, mut high) = (0.0, size);
        if self.value(watched, self.time + size, end) >= if start > rounding { 0.0 } else { -rounding } {
            high = self.dip(watched, size, end).filter(|&bottom| start > rounding && after(bottom) < 0.0)?;
        } else if start <= rounding {
            low = (1..60).map(|n| size * 0.5_f64.powi(n)).find(|&elapsed| after(elapsed) > 0.0).unwrap_or(0.0);
        }
        for _ in 0..60 {
            let middle = 0.5 * (low + high);
            if after(middle) > 0.0 {
                low = middle;
            } else {
                high = middle;
            }
        }
        Some(low)
    }

    /// Returns the minimum in a step of a function that falls at first and rises at the end.
    fn dip(&self, watched: Watched, size: f64, end: &State) -> Option<f64> {
        let slopes = [(self.time, &self.state), (self.time + size, end)].map(|(time, state)| match watched {
            Watched::Reaction(i) => {
                let forces = self.forces(time, state, self.touching, self.foot.is_some());
                -self.support_rate(self.height(state, i)[1], self.corner_acceleration(state, &forces, i))
            }
            Watched::Gap(i) => self.top_rate(state, i) - self.height(state, i)[1],
            Watched::Held(_) | Watched::Unloaded(_) | Watched::Slide => 0.0,
        });
        if !(slopes[0] > 0.0 && slopes[1] < 0.0) {
            return None;
        }
        let value = |elapsed: f64| self.value(watched, self.time + elapsed, &self.step(elapsed));
        let (mut low, mut high) = (0.0, size);
        for _ in 0..40 {
            let [left, right] = [(2.0 * low + high) / 3.0, (low + 2.0 * high) / 3.0];
            if value(left) < value(right) {
                high = right;
            } else {
                low = left;
            }
        }
        Some(0.5 * (low + high))
    }

    fn apply(&mut self, watched: Watched) {
        let before = self.touching;
        let mut exact = [None; 2];
        let kind = match watched {
            Watched::Reaction(i) | Watched::Held(i) => {
                let rate = match watched {
                    Watched::Held(_) => self.top_rate(&self.state, i),
                    _ => self.height(&self.state, i)[1],
                };
                let opens = self.foot.is_none() || self.opening(self.time, &self.state, i, rate) >= 0.0;
                if opens {
                    self.held = None;
                    self.lift(i);
                    Kind::LiftOff(i)
                } else if before == [true; 2] {
                    // It bears no load, and stays on its support.
                    self.held = matches!(watched, Watched::Reaction(_)).then_some(i);
                    if self.held.is_some() {
                        return;
                    }
                    Kind::LiftOff(i)
                } else {
                    self.foot = None;
                    self.events.push(IndependentEvent { time: self.time, kind: Kind::Slip, before, after: before });
                    self.used.insert(Rule::Slip);
                    return;
                }
            }
            Watched::Unloaded(_) => {
                self.held = None;
                return;
            }
            Watched::Gap(i) => {
                self.land(i, &mut exact);
                Kind::Landing(i)
            }
            Watched::Slide => {
                self.used.insert(Rule::Grip);
                self.grip();
                Kind::Grip
            }
        };
        self.apply_pending_event(BOTH.map(|i| self.touching[i] && !before[i]), exact);
        self.events.push(IndependentEvent { time: self.time, kind, before, after: self.touching });
    }

    fn lift(&mut self, i: usize) {
        let both = self.touching == [true; 2];
        self.touching[i] = false;
        self.liftoffs += 1;
        let free = self.block.static_deflection();
        self.state[6 + i] = if self.block.damping > 0.0 { self.height(&self.state, i)[0] } else { free };
        if self.touching == [false; 2] {
            self.foot = None;
        } else if both && self.foot.is_some() {
            // From here on the other corner is held, at its distance from the middle, with unchanged v̇ and θ̇.
            self.state = self.held_by(&self.state, self.touching);
            self.put_on_foot();
        }
    }

    fn put_on_foot(&mut self) {
        let (Some(foot), foothold) = (self.foot, self.foothold(self.touching)) else { return };
        self.state[0] = foot + foothold.x - Self::arm(&self.state, foothold).x;
    }

    /// Lands a corner; `exact` receives the rates prescribed by the landing.
    fn land(&mut self, i: usize, exact: &mut [Option<f64>; 2]) {
        let other = 1 - i;
        let before = self.touching;
        let rate = self.height(&self.state, i)[1];
        match (before == [false; 2], self.foot) {
            // The other corner stands.
            (false, Some(_)) => {
                self.touching[i] = true;
                if rate < 0.0 {
                    self.used.insert(Rule::Impact);
                    self.impacts += 1;
                    exact[i] = Some(self.block.epsilon * rate);
                    (self.state, _) = self.strike(&self.state, Some([self.corner(i), self.middle()]), *exact);
                } else {
                    self.used.insert(Rule::RisingSupport);
                    self.state = self.held_by(&self.state, self.touching);
                }
                self.put_on_foot();
            }
            // The other corner slides.
            (false, None) => {
                self.used.insert(Rule::LandingBesideSlide);
                self.impacts += u32::from(rate < 0.0);
                self.touching[i] = true;
                exact[i] = Some(self.after_landing(i, rate));
                (self.state, _) = self.strike(&self.state, None, *exact);
            }
            (true, _) => {
                let level = self.gap(&self.state, other) <= self.rounding(Watched::Gap(other));
                let closing = self.height(&self.state, other)[1] < self.top_rate(&self.state, other);
                let mut lands = i;
                if level && closing {
                    let rates = BOTH.map(|i| Some(self.after_landing(i, self.height(&self.state, i)[1])));
                    let middle = self.middle();
                    let (state, impulses) = self.strike(&self.state, Some([middle, middle]), rates);
                    if impulses[0] >= 0.0 && impulses[1] >= 0.0 {
                        self.used.insert(Rule::LandingOnBoth);
                        self.impacts += 2;
                        self.state = state;
                        self.touching = [true; 2];
                        *exact = rates;
                        return self.take_hold();
                    }
                    if impulses[i] < 0.0 {
                        self.used.insert(Rule::OtherLandsAlone);
                        lands = other;
                    }
                }
                self.land_alone(lands, exact);
            }
        }
    }

    fn land_alone(&mut self, i: usize, exact: &mut [Option<f64>; 2]) {
        let rate = self.height(&self.state, i)[1];
        let corner = self.corner(i);
        self.touching[i] = true;
        self.impacts += u32::from(rate < 0.0);
        let mut rates = [None; 2];
        rates[i] = Some(self.after_landing(i, rate));
        let (mut state, impulses) = self.strike(&self.state, Some([corner, corner]), rates);
        if rate >= 0.0 || impulses[i] < 0.0 {
            self.used.insert(Rule::NoPull);
            // No support pulls: apply the horizontal impulse alone, and take the corner's rate from it.
            let (thrown, _) = self.strike(&self.state, Some([corner, corner]), [None; 2]);
            rates[i] = Some(self.or_rest(i, self.height(&thrown, i)[1]));
            (state, _) = self.strike(&self.state, Some([corner, corner]), rates);
        }
        self.state = state;
        *exact = rates;
        self.take_hold();
    }

    fn after_landing(&self, i: usize, rate: f64) -> f64 {
        self.or_rest(i, if rate < 0.0 { self.block.epsilon * rate } else { rate })
    }

    /// Returns the support's rate if a flight would rise less than ten times the round-off of a gap.
    fn or_rest(&self, i: usize, rate: f64) -> f64 {
        let top = self.top_rate(&self.state, i);
        let rise = (rate - top).powi(2) / (2.0 * self.block.gravity);
        if rate > top && rise < 10.0 * self.rounding(Watched::Gap(i)) { top } else { rate }
    }

    /// Holds the touching corners at their present position.
    fn take_hold(&mut self) {
        let foothold = self.foothold(self.touching);
        self.foot = Some(self.state[0] + Self::arm(&self.state, foothold).x - foothold.x);
    }

    fn grip(&mut self) {
        let foothold = self.foothold(self.touching);
        (self.state, _) = self.strike(&self.state, Some([foothold, foothold]), [None; 2]);
        self.take_hold();
    }

    /// Releases the touching corners whose supports would have to pull, now or within the resolution of the clock. `exact` are
    /// rates known more accurately than from the state.
    fn apply_pending_event(&mut self, landed: [bool; 2], exact: [Option<f64>; 2]) {
        let gravity = self.block.gravity;
        self.held = None;
        let resolution = 4.0 * f64::EPSILON * self.time.max(1.0 / self.block.omega_v);
        // A corner that has just landed is exactly as high as its support; a difference of larger numbers would lose that.
        let mut exact = BOTH.map(|i| {
            let [height, rate] = self.height(&self.state, i);
            if landed[i] { [self.state[6 + i], exact[i].unwrap_or(rate)] } else { [height, rate] }
        });
        for i in BOTH.into_iter().filter(|&i| self.touching[i]) {
            self.state[6 + i] = exact[i][0];
        }
        loop {
            let slides = self.foot.is_none() && self.touching != [false; 2];
            if slides && self.pressure(&self.state) > self.rounding(Watched::Slide) {
                self.used.insert(Rule::Grip);
                self.grip();
                for i in BOTH {
                    exact[i][1] = self.height(&self.state, i)[1];
                }
            }
            let forces = self.forces(self.time, &self.state, self.touching, self.foot.is_some());
            let mut drop: Option<(f64, usize)> = None;
            for i in BOTH.into_iter().filter(|&i| self.touching[i]) {
                let rate = exact[i][1];
                let n = self.support(exact[i]);
                let n = if n.abs() <= 1e-13 * gravity { 0.0 } else { n };
                let acceleration = self.corner_acceleration(&self.state, &forces, i);
                let n_rate = self.support_rate(rate, acceleration);
                let falls =
                    n + n_rate * resolution < 0.0 || n == 0.0 && (n_rate < 0.0 || n_rate == 0.0 && acceleration > 0.0);
                let opens = || self.opening(self.time, &self.state, i, rate) >= 0.0;
                if n < 0.0 || falls && (self.foot.is_none() || opens()) {
                    drop = drop.filter(|&(least, _)| least <= n).or(Some((n, i)));
                } else if falls && self.touching == [true; 2] {
                    self.held = Some(i);
                } else if falls {
                    self.used.insert(Rule::Slip);
                    self.foot = None;
                }
            }
            let Some((_, i)) = drop else { break };
            self.lift(i);
        }
    }
}
