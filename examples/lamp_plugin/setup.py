"""Makes the module of the plugin importable; run by catkin."""
from catkin_pkg.python_setup import generate_distutils_setup
from setuptools import setup

setup(**generate_distutils_setup(packages=["lamp_plugin"], package_dir={"": "src"}))
