"""PPO from RLlib learns to grasp, in RLlib's new API stack, from a Dict of senses.

You learn to make RLlib step native batches, and to test its policy on held-out cases. RLlib pins
its own Gymnasium: install it apart, with `pip install 'gym-babble[rllib]'`.
"""

import argparse
import logging
from time import perf_counter

import ray
import torch
from ray.rllib.algorithms.ppo import PPOConfig
from ray.rllib.algorithms.ppo.torch.default_ppo_torch_rl_module import DefaultPPOTorchRLModule
from ray.rllib.core.rl_module.default_model_config import DefaultModelConfig
from ray.rllib.core.rl_module.rl_module import RLModuleSpec

from gym_babble import evaluate, scenarios
from gym_babble.rllib import RLlibAgent, native_batch

parser = argparse.ArgumentParser(description=__doc__)
parser.add_argument("--env-id", default="BabbleGrasp-v0")
parser.add_argument("--iterations", type=int, default=60, help="of 8,192 steps each")
parser.add_argument("--every", type=int, default=10, help="iterations between two tests")
parser.add_argument("--cases", type=int, default=200, help="validation cases of a test")
parser.add_argument("--runners", type=int, default=0, help="processes that step a batch each")
parser.add_argument("--seed", type=int, default=0)
arguments = parser.parse_args()


class Policy(DefaultPPOTorchRLModule):
    """RLlib's networks, with less noise in the first actions."""

    def setup(self) -> None:
        """Sets the standard deviation, which is 1 otherwise."""
        super().setup()
        torch.nn.init.constant_(self.pi.log_std, -0.5)


hidden = {"fcnet_hiddens": [128, 128], "fcnet_activation": "relu"}
networks = DefaultModelConfig(**hidden, free_log_std=True, vf_share_layers=False)
config = (
    native_batch(PPOConfig(), arguments.env_id, num_envs=128)
    .env_runners(num_env_runners=arguments.runners)
    .rl_module(rl_module_spec=RLModuleSpec(module_class=Policy, model_config=networks))
    .training(
        train_batch_size_per_learner=8_192,
        minibatch_size=1_024,
        num_epochs=5,
        lr=1e-3,
        gamma=0.99,
        lambda_=0.95,
        clip_param=0.2,
        vf_clip_param=float("inf"),
        vf_loss_coeff=0.5,
        use_kl_loss=False,
        grad_clip=0.5,
        grad_clip_by="global_norm",
    )
    .debugging(seed=arguments.seed)
)
torch.set_num_threads(1)  # These networks are too small for a second one to help.
logging.getLogger("ray").setLevel(logging.ERROR)
ray.init(include_dashboard=False, logging_level="error")
algorithm = config.build_algo()
cases = scenarios("palm_side", arguments.cases, split="validation")
began = perf_counter()
for i in range(1, arguments.iterations + 1):
    result = algorithm.train()
    if i % arguments.every == 0:
        success = evaluate(RLlibAgent(algorithm), cases=cases).rate("success")
        steps = result["env_runners"]["num_env_steps_sampled_lifetime"]
        print(f"{steps:9,.0f} steps {perf_counter() - began:4.0f} s: success {success:.3f}")
low, high = evaluate(RLlibAgent(algorithm), cases=cases).interval("success")
algorithm.stop()
ray.shutdown()
print(f"ray {ray.__version__}: success {success:.3f} [{low:.3f}, {high:.3f}]")
