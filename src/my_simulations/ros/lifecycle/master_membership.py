"""A node's place on the graph: registered again when a new master has taken over.

A master that is started anew knows nobody, and rospy does not look after that: the node would go on
without anyone finding it.
"""
from __future__ import annotations

from typing import Callable

import rospy
from rospy.impl.registration import (
    get_registration_listeners,
    get_service_manager,
    get_topic_manager,
)

from . import master_api


class Membership:
    """Looks now and then whether the master knows this node, and registers it again if not.

    Args:
        uri: of the master.
        name: of this node.
        renewed: called after the node has been registered again, to set its parameters.
    """

    def __init__(self, uri: str, name: str, renewed: Callable[[], None]) -> None:
        self._uri = uri
        self._name = name
        self._renewed = renewed
        self._away = False
        self._owed = False

    def keep_up(self) -> bool:
        """Whether the master answers and knows this node; a fault is logged once.

        Raises:
            OSError: it went away in the middle; the next call goes on.
        """
        try:
            known = master_api.call(self._uri, "lookupNode", self._name, self._name)
        except OSError as fault:
            if not self._away:
                rospy.logwarn("the ROS master at %s does not answer (%s); the world runs on, and "
                              "the node registers again when there is a master", self._uri, fault)
            self._away = True
            return False
        if known and not self._owed:
            if self._away:
                rospy.loginfo("the ROS master at %s answers again", self._uri)
            self._away = False
            return True
        if known and known != rospy.get_node_uri():
            return True  # another node took the name; rospy ends this one
        self._owed = True  # until all of it has been done
        self._register()
        self._renewed()
        self._owed = self._away = False
        rospy.logwarn("a new ROS master is at %s; the node %s has registered again with all its "
                      "topics, services and parameters", self._uri, self._name)
        return True

    def _register(self) -> None:
        topics, services = get_topic_manager(), get_service_manager()
        here = rospy.get_node_uri()
        for topic, kind in topics.get_publications():
            self._call("registerPublisher", topic, kind, here)
        for service, address in services.get_services():
            self._call("registerService", service, address, here)
        for topic, kind in topics.get_subscriptions():
            publishers = self._call("registerSubscriber", topic, kind, here) or []
            for listener in list(get_registration_listeners().listeners):
                listener.publisher_update(topic, publishers)

    def _call(self, method: str, *arguments: str) -> object:
        return master_api.call(self._uri, method, self._name, *arguments)
