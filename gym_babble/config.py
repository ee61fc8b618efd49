"""Body and task as dataclasses: every number of the model, with its unit and source.

Sources: [P] the paper, [A] derived from it, [F] fitted to its tables, [C] our choice.
A config is a profile (`"paper"` or `"icub"`) with any of its fields replaced:

    >>> from dataclasses import replace
    >>> from gym_babble import Config
    >>> config = Config.profile_named("paper")
    >>> longer = replace(config, body=replace(config.body, arm=Arm(upper_arm_m=0.2)))

or, where only a few numbers change, a dict: `{"profile": "icub", "reach": {"movement_s": 5.0}}`.
"""

from __future__ import annotations

import json
from collections.abc import Mapping
from dataclasses import dataclass, field, fields, is_dataclass
from pathlib import Path
from typing import Any, TypeAlias, get_type_hints

from gym_babble import _core
from gym_babble.checks import check_choice, check_path, check_text, plain, shown
from gym_babble.errors import ConfigError

__all__ = [
    "Arm",
    "Body",
    "Config",
    "ConfigLike",
    "Contact",
    "Cylinder",
    "EyeConfig",
    "GraspConfig",
    "Grip",
    "Hand",
    "Joint",
    "Muscles",
    "Noise",
    "Object",
    "ReachConfig",
    "RegionConfig",
    "Target",
    "config_json",
]


@dataclass(frozen=True, kw_only=True)
class Arm:
    """The arm's two segments."""

    upper_arm_m: float = 0.15
    """Length of the upper arm [m] [P]."""
    forearm_m: float = 0.13
    """Length of the forearm [m] [P]."""
    half_width_m: float = 0.01
    """Half-width of arm and hand [m] [F]. Larger touches obstacles earlier."""
    density_kg_m3: float = 1100.0
    """Density of arm and hand [kg/m³] [C]. Hardly matters beside the muscles' damping."""


@dataclass(frozen=True, kw_only=True)
class Hand:
    """The hand's segments."""

    palm_m: float = 0.055
    """Length of the palm from the wrist to the fingers' pivots [m] [C]."""
    palm_height_m: float = 0.06
    """Height of the palm across the plane of motion [m] [C]."""
    finger_m: tuple[float, float, float, float] = (0.01, 0.02, 0.017, 0.014)
    """Pivot segment and three phalanges of each finger [m] [P]."""
    thumb_m: tuple[float, float, float, float] = (0.02, 0.02, 0.017, 0.014)
    """Pivot segment and three phalanges of the thumb [m] [P]."""
    finger_spacing_m: float = 0.015
    """Distance between neighbouring fingers [m] [C]."""


@dataclass(frozen=True, kw_only=True)
class Joint:
    """One of the 26 joints."""

    lower_deg: float
    """Lower end of the range [deg]."""
    upper_deg: float
    """Upper end of the range [deg]."""
    locked_deg: float | None = None
    """Angle at which the joint is held [deg]; None for shoulder and elbow, which move."""


@dataclass(frozen=True, kw_only=True)
class Muscles:
    """The muscles of Eq. 2, T = K_P (q_des − q) − K_D q̇."""

    kp: float = 50.0
    """Stiffness K_P [N·m/rad] [P, unit C]."""
    kd: float = 40.0
    """Damping K_D [N·m·s/rad] [P, unit C]. The arm's time constant is kd / kp seconds."""
    torque_max: float = 50.0
    """Torque of an action of 1 in torque control [N·m] [C]; at most 1000 K_D."""


@dataclass(frozen=True, kw_only=True)
class EyeConfig:
    """The camera and its frame."""

    position_m: tuple[float, float, float] = (0.0, 0.1, 0.25)
    """Position from the shoulder [m]: x right, y forward, z up [P]."""
    pixels: int = 630
    """Edge of the image [pixel] [P]."""
    field_deg: float = 120.0
    """Field of view along each edge [deg] [P]."""
    frame: str = "helmholtz"
    """Order of the axes: "helmholtz" (tilt, then pan; zero straight down) [F] or "fick" (pan, then
    tilt; zero straight ahead) [C]."""
    pan_deg: tuple[float, float] = (-65.0, 65.0)
    """Range of pan [deg], the eye's proprioception 0…1 [F]."""
    tilt_deg: tuple[float, float] = (-65.0, 65.0)
    """Range of tilt [deg], the eye's proprioception 0…1 [F]."""


@dataclass(frozen=True, kw_only=True)
class Cylinder:
    """The vertical obstacle."""

    radius_m: float = 0.035
    """Radius [m] [F]; 0.02 [C] in profile "icub"."""
    height_m: float = 0.12
    """Height [m], half of it above the arm's plane [C]."""


@dataclass(frozen=True, kw_only=True)
class Target:
    """The red sphere to be reached; it is immaterial."""

    radius_m: float = 0.012
    """Radius [m] [C]."""


@dataclass(frozen=True, kw_only=True)
class Grip:
    """The hand as it grasps.

    Flexion is counted from the open hand; the paper's equilibrium points are opening angles,
    EP = 90° − flexion [F].
    """

    fingers: str = "virtual"
    """The four fingers share one command, the "virtual finger" [P]. "virtual": they are one chain
    of three joints [C]; "independent": twelve joints, so that they envelop an object one by one, at
    1.2 to 1.5 times the cost of a physics step."""
    thumb_base_m: tuple[float, float] = (0.0, 0.006)
    """Where the thumb sits: along the forearm from the wrist, towards the palm's side [m] [C]."""
    thumb_direction_deg: float = 154.7
    """Direction of the open thumb, counter-clockwise from the forearm [deg]: 2.7 rad [C]. Its four
    joints flex clockwise, against the fingers."""
    flexion_deg: tuple[float, float] = (0.0, 90.0)
    """Lowest and highest flexion of every joint of thumb and fingers [deg] [C]."""
    reflex_deg: tuple[float, float] = (57.0, 80.0)
    """Flexion that the enclosure reflex asks of thumb and fingers [deg] [C]. That it asks for
    angles is Sect. IV-A's; Sect. IV speaks of constant torques. Less holds small objects loosely;
    with rapier, more ejects them."""
    arm_muscles: Muscles = field(
        default_factory=lambda: Muscles(kp=200.0, kd=200.0, torque_max=200.0)
    )
    """Muscles of shoulder and elbow: K_P and K_D [P], torque_max [C]."""
    hand_muscles: Muscles = field(default_factory=lambda: Muscles(kp=0.5, kd=0.5, torque_max=0.5))
    """Muscles of the hand's joints [C]. The paper's 200 and 200 crush or eject a light ball; the
    time constant, 1 s, is the same."""


@dataclass(frozen=True, kw_only=True)
class Object:
    """The red sphere to be grasped and what it rests on."""

    density_kg_m3: float = 500.0
    """Density [kg/m³] [C]."""
    friction: float = 0.8
    """Coulomb friction between object and hand [C]."""
    support_friction: float = 0.5
    """Coulomb friction between object and support, at most that of the object [C]."""
    linear_damping: float = 0.5
    """Damping of its motion [1/s] [C]."""
    angular_damping: float = 20.0
    """Damping of its rotation, which stands for rolling friction [1/s] [C]."""


@dataclass(frozen=True, kw_only=True)
class Contact:
    """How hard surfaces are: each contact is a spring, a damper and Coulomb friction."""

    stiffness_n_m: float = 20_000.0
    """Stiffness of a contact [N/m] [C]."""
    relaxation_s: float = 0.013
    """Damping of a contact divided by its stiffness: the time in which surfaces part when nothing
    presses them [s] [C]."""
    stiction_m_s: float = 1e-4
    """Sliding speed at which friction is 0.7 of its full force [m/s] [C]. What seems to stick
    creeps at a fraction of it."""


def _paper_joints() -> dict[str, Joint]:
    return Config.profile_named("paper").body.joints


@dataclass(frozen=True, kw_only=True)
class Body:
    """The whole body and the things in its world."""

    engine: str = "tree"
    """What steps the world in grasping [C]: an engine made for this robot, or rapier3d, its
    reference, some ten times slower."""
    arm: Arm = field(default_factory=Arm)
    hand: Hand = field(default_factory=Hand)
    joints: dict[str, Joint] = field(default_factory=_paper_joints)
    """Ranges and locks of the 26 joints. Shoulder −75…180°, elbow 5…130° [F]; −10…95° and
    15…106° in profile "icub" [C]; the others are locked [P], at 0 [C]."""
    muscles: Muscles = field(default_factory=Muscles)
    eye: EyeConfig = field(default_factory=EyeConfig)
    obstacle: Cylinder = field(default_factory=Cylinder)
    target: Target = field(default_factory=Target)
    grip: Grip = field(default_factory=Grip)
    object: Object = field(default_factory=Object)
    contact: Contact = field(default_factory=Contact)


@dataclass(frozen=True, kw_only=True)
class ReachConfig:
    """The reaching task."""

    distance_m: tuple[float, float] = (0.08, 0.25)
    """Lowest and highest distance from start to target [m] [F]; 0.1…0.2 [C] in profile "icub"."""
    success_radius_m: float = 0.02
    """Success when the fingertip is at most this far from the target [m] [C]."""
    b_range: tuple[float, float] = (0.01, 0.99)
    """Lowest and highest b1 and b2 [C]."""
    movement_s: float = 8.0
    """Movement time T of the pattern generators [s] [C]. Shorter movements lose their curvature to
    the muscles' lag."""
    settle_time_constants: float = 4.0
    """Time to settle after T, in muscle time constants [C]; 120 s at most."""
    delta_posture_deg: float = 5.0
    """Change of an equilibrium point by an action of 1 in `delta_posture` control [deg] [C]."""
    settled_speed_rad_s: float = 0.05
    """Joint speed below which the arm counts as settled [rad/s] [C]."""
    control_period_s: float = 0.05
    """Time between two actions [s] [C]."""
    physics_steps: int = 10
    """Physics steps in a control period [C]."""


@dataclass(frozen=True, kw_only=True)
class RegionConfig:
    """Where objects lie and arms start."""

    radius_m: tuple[float, float]
    """Distance of the object's centre from the shoulder: lowest and highest [m]."""
    polar_deg: tuple[float, float]
    """Direction of the object from the shoulder, counter-clockwise from x [deg]."""
    shoulder_deg: tuple[float, float]
    """Shoulder at the start [deg], cut to the joint range."""
    elbow_deg: tuple[float, float]
    """Elbow at the start [deg], cut to the joint range."""


@dataclass(frozen=True, kw_only=True)
class GraspConfig:
    """The grasping task."""

    diameters_m: tuple[float, ...] = (0.024, 0.06)
    """Diameters of the objects [m] [F]. The printed 12 and 30 cm cannot be enclosed."""
    any_diameter_between: bool = False
    """Whether a diameter is drawn from all between the smallest and the largest, and not from the
    list [C]."""
    palm_side: RegionConfig = field(
        default_factory=lambda: RegionConfig(
            radius_m=(0.15, 0.29),
            polar_deg=(40.0, 160.0),
            shoulder_deg=(-75.0, -15.0),
            elbow_deg=(5.0, 90.0),
        )
    )
    """Objects on the palm's side of the arm [C]; polar 90…160°, shoulder −10…10°, elbow 15…90° in
    profile "icub"."""
    full: RegionConfig = field(
        default_factory=lambda: RegionConfig(
            radius_m=(0.13, 0.29),
            polar_deg=(-20.0, 160.0),
            shoulder_deg=(-360.0, 360.0),
            elbow_deg=(0.0, 180.0),
        )
    )
    """Objects and starts all over the plane [C]."""
    clearance_m: float = 0.005
    """Least distance from arm and open hand to the object at the start [m] [C]."""
    hold_steps: int = 20
    """Control steps over which a grasp must enclose the object, and over which it must then hold it
    without support [C]."""
    enclosed_share: float = 0.95
    """Least share of physics steps in which the hand alone encloses the object, before the support
    goes [C]."""
    held_share: float = 0.9
    """Share of such physics steps that must be exceeded after it went [C]."""
    palm_reach_m: float = 0.06
    """The object counts as in the hand when its centre is on the palm's side and at most its radius
    and this far from the palm's centre [m] [C]."""
    success_radius_m: float = 0.02
    """In the goal form the object is where it should be within this distance [m] [C]."""
    delta_posture_deg: float = 5.0
    """Change of an equilibrium point by an action of 1 in `delta_posture` control [deg] [C]."""
    touch_max_n: float = 20.0
    """Normal force that the sense of touch calls 1 [N] [C]."""
    control_period_s: float = 0.05
    """Time between two actions [s] [C]."""
    physics_steps: int = 10
    """Physics steps in a control period [C]. At 10 ms a step grasps slip; 20 ms are the most."""


@dataclass(frozen=True, kw_only=True)
class Noise:
    """Standard deviations of errors of senses and muscles [C]; none by default.

    Each control step has errors of its own, independent and normal with mean 0, from the episode's
    random stream. Muscles have theirs while the arm moves, senses when they are shown; these are
    cut to the bounds of the sense. Goals, rewards and facts have none. Movements that are babbled
    in reaching have the same noise; babbles of grasping have none.
    """

    joint_deg: float = 0.0
    """Felt joint angles [deg]: the senses `arm`, `stretch` and, in grasping, `hand`. A joint has
    one error, which `stretch` shows with the opposite sign."""
    eye_deg: float = 0.0
    """Felt pan and tilt [deg]: the sense `eye`. The gaze itself has no error."""
    sight_deg: float = 0.0
    """Seen directions [deg]: the senses `hand` and `obstacle` of reaching."""
    fovea: float = 0.0
    """Edges in the fovea, of which the strongest is 1: the sense `fovea`."""
    touch_n: float = 0.0
    """Felt normal forces [N]: the sense `touch`."""
    motor_deg: float = 0.0
    """Equilibrium points that the muscles pull to [deg], cut to the joint ranges. In `torque`
    control a muscle's torque has this error times K_P."""


@dataclass(frozen=True, kw_only=True)
class Config:
    """Body and tasks."""

    profile: str = "paper"
    """The profile that this config started from."""
    body: Body = field(default_factory=Body)
    reach: ReachConfig = field(default_factory=ReachConfig)
    grasp: GraspConfig = field(default_factory=GraspConfig)
    noise: Noise = field(default_factory=Noise)

    @classmethod
    def profile_named(cls, name: str) -> Config:
        """The config of a profile, "paper" or "icub".

        Raises:
            ConfigError: There is no profile of that name.
        """
        return cls.from_json(_core.profile_config(check_choice("name", name, _core.profiles())))

    @classmethod
    def load(cls, path: str | Path) -> Config:
        """A config from a TOML or JSON file that holds what differs from its profile.

        Raises:
            ConfigError: The file cannot be read, is no text or larger than a megabyte, or a field
                is unknown, given twice or out of bounds.
        """
        return cls.from_json(_core.load_config(check_path("path", path)))

    @classmethod
    def from_json(cls, text: str) -> Config:
        """A config from JSON that holds what differs from its profile.

        Raises:
            ConfigError: A field is unknown, given twice or out of bounds.
        """
        text = _core.complete_config(check_text("text", text))
        config: Config = _build(cls, json.loads(text))
        return config

    @property
    def movement_steps(self) -> int:
        """Control steps of one whole movement: T, and the time to settle."""
        muscles, reach = self.body.muscles, self.reach
        settle_s = reach.settle_time_constants * muscles.kd / muscles.kp
        return round((reach.movement_s + settle_s) / reach.control_period_s)

    def to_json(self) -> str:
        """The whole config as JSON, without the noise if there is none.

        Raises:
            ConfigError: A field is not a number, a text or a list of these, or not finite.
        """
        document = plain(self, "", kind="config: ")
        if self.noise == Noise():
            del document["noise"]
        return json.dumps(document)


ConfigLike: TypeAlias = "str | Path | Mapping[str, Any] | Config"
"""What `config=` takes: a profile's name, a file's path, a dict of differences, or a `Config`."""


def config_json(config: ConfigLike) -> str:
    """The complete, checked config for what `config=` takes, as JSON.

    Raises:
        ConfigError: A name, field or value is not one there is.
    """
    if isinstance(config, Config | Mapping):
        return _core.complete_config(json.dumps(plain(config, "", kind="config: ")))
    if isinstance(config, Path):
        return _core.load_config(check_path("config", config))
    if isinstance(config, str):
        if config.endswith((".toml", ".json")):
            return _core.load_config(check_path("config", config))
        profiles = _core.profiles()
        if config in profiles:
            return _core.profile_config(config)
        raise ConfigError(
            f"config = {shown(config)} is not one of {', '.join(profiles)}, and not a file that "
            "ends in .toml or .json"
        )
    raise ConfigError(
        f"config is a {type(config).__name__}, not a profile's name, a path, a dict or a Config"
    )


def _build(kind: Any, value: Any) -> Any:
    """A dataclass of type `kind` from what JSON holds."""
    if isinstance(kind, type) and is_dataclass(kind):
        hints = get_type_hints(kind)
        given = [f.name for f in fields(kind) if f.name in value]
        return kind(**{name: _build(hints[name], value[name]) for name in given})
    if kind == dict[str, Joint]:
        return {name: _build(Joint, joint) for name, joint in value.items()}
    return tuple(value) if isinstance(value, list) else value
