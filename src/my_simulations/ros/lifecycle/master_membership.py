"""Registers the node again after a restart of the ROS master.

A restarted master has no registrations, and rospy does not renew them: no other node could find
this one.
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
    """Checks whether the node is registered, and registers it again if not.

    Args:
        uri: URI of the master.
        name: name of this node.
        renewed: called after the node was registered again, to set its parameters.
    """

    def __init__(self, uri: str, name: str, renewed: Callable[[], None]) -> None:
        self._uri = uri
        self._name = name
        self._renewed = renewed
        self._away = False
        self._owed = False

    def refresh(self) -> bool:
        """Whether the node is registered; an unreachable master is logged once.

        Raises OSError: the master became unreachable meanwhile; the next call continues.
        """
        try:
            known = master_api.call(self._uri, "lookupNode", self._name, self._name)
        except OSError as fault:
            if not self._away:
                rospy.logwarn("the ROS master at %s does not respond (%s); the simulation "
                              "continues,"
                              " and the node registers again once a master is "
                              "available", self._uri, fault)
            self._away = True
            return False
        if known and not self._owed:
            if self._away:
                rospy.loginfo("the ROS master at %s responds again", self._uri)
            self._away = False
            return True
        if known and known != rospy.get_node_uri():
            return True  # another node took the name; rospy ends this one
        self._owed = True  # until all of it has been done
        self._register()
        self._renewed()
        self._owed = self._away = False
        rospy.logwarn("the ROS master at %s was restarted; registered the node %s again with its "
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
