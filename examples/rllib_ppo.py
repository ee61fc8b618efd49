"""PPO from RLlib's new API stack on the native batch: a few training steps.

RLlib pins its own Gymnasium and brings much else: `make frameworks` runs this apart.
The prefix in `gym_babble:BabbleReach-v0` makes each of Ray's workers import the package.
"""

import argparse

import ray
from ray.rllib.algorithms.ppo import PPOConfig

parser = argparse.ArgumentParser(description=__doc__)
parser.add_argument("--iterations", type=int, default=3)
parser.add_argument("--workers", type=int, default=1, help="processes that step a batch each")
parser.add_argument("--envs", type=int, default=32, help="environments in a batch")
arguments = parser.parse_args()

config = (
    PPOConfig()
    .environment("gym_babble:BabbleReach-v0", env_config={"obs": "flat"})
    .env_runners(
        num_env_runners=arguments.workers,
        num_envs_per_env_runner=arguments.envs,
        gym_env_vectorize_mode="vector_entry_point",
    )
    .training(train_batch_size_per_learner=4096, minibatch_size=512, num_epochs=5, lr=1e-3)
)
algorithm = config.build_algo()
for i in range(arguments.iterations):
    result = algorithm.train()
    runners = result["env_runners"]
    print(
        f"iteration {i + 1}: {runners['num_env_steps_sampled_lifetime']:.0f} steps, "
        f"mean return {runners['episode_return_mean']:.3f}"
    )
algorithm.stop()
ray.shutdown()
print(f"ray {ray.__version__}: {arguments.iterations} iterations done")
