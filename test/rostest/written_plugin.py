"""A plugin whose module the test `bad_plugins` writes while the node runs."""
import sys

import rospy

sys.path.insert(0, rospy.get_param("/written_plugin/folder"))

from module_under_test import Written  # noqa: F401  (the node looks it up)
